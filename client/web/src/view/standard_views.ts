// SPDX-License-Identifier: Apache-2.0
// The views that everybody knows by name, and which axis is up.

import { cameraAxes } from "./camera_math";
import type { CameraState, Vec } from "./types";
import { along, distance, dot, normalise, scale, subtract } from "./vector";

/// The axis of the mesh's file that points up: files of one kind or maker mostly agree on it.
export type UpAxis = "y" | "z";
export type StandardView = "home" | "front" | "side" | "top";

/// Looks from the front, a little from above and from the right, as in the pictures that the server renders.
export const firstCamera: CameraState = { eye: [0.55, 0.35, 1], target: [0, 0, 0], up: [0, 1, 0], fov: 30 };

const steepest = Math.cos(0.012); // a camera has to see where its up direction is

/// Turns a vector from files with y up to those with z up: right stays right, and what was in front stays there.
const lyingDown = ([x, y, z]: Vec): Vec => [x, -z, y];
const standingUp = ([x, y, z]: Vec): Vec => [x, z, -y];

/// Returns the direction from the surface to the eye.
export function directionOf(view: StandardView, up: UpAxis): Vec {
  const directions: Record<StandardView, Vec> = { home: firstCamera.eye, front: [0, 0, 1], side: [1, 0, 0], top: [0, 1, 0] };
  return up === "y" ? directions[view] : lyingDown(directions[view]);
}

/// Moves the eye to another side of the target, as far away as before. From right above or below, what is in front is at the lower edge
/// of the picture, or at the upper one.
export function lookFrom(camera: CameraState, direction: Vec, up: UpAxis): CameraState {
  const upwards: Vec = up === "y" ? [0, 1, 0] : [0, 0, 1];
  let from = normalise(direction, directionOf("front", up));
  const height = dot(from, upwards);
  if (Math.abs(height) > steepest) {
    const side = Math.sqrt(1 - steepest ** 2);
    from = along(scale(upwards, Math.sign(height) * steepest), directionOf("front", up), side);
  }
  return { ...camera, up: upwards, eye: along(camera.target, from, distance(camera.eye, camera.target)) };
}

/// Returns the axis that points up in a camera's picture.
export function upAxisOf({ up }: CameraState): UpAxis {
  return Math.abs(up[2]) > Math.abs(up[1]) ? "z" : "y";
}

/// Has another axis point up: the camera looks from the same side as before, seen from what is now upright.
export function withUp(camera: CameraState, up: UpAxis): CameraState {
  if (up === upAxisOf(camera)) return camera;
  const from = subtract(camera.eye, camera.target);
  return lookFrom(camera, up === "y" ? standingUp(from) : lyingDown(from), up);
}

/// Changes the angle of view, and moves the eye so that what is at the target stays as large.
export function withFieldOfView(camera: CameraState, fov: number): CameraState {
  const reach = (distance(camera.eye, camera.target) * Math.tan((camera.fov * Math.PI) / 360)) / Math.tan((fov * Math.PI) / 360);
  return { ...camera, fov, eye: along(camera.target, cameraAxes(camera).forward, -reach) };
}
