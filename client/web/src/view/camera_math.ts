// SPDX-License-Identifier: Apache-2.0
// Functions of camera states: how a camera moves, and what it sees. Angles in radians.

import type { CameraState, Ray, Vec } from "./types";
import { add, along, cross, distance, dot, isFinite, length, normalise, perpendicular, rotate, scale, subtract } from "./vector";

/// The corners of a box.
export interface Bounds {
  min: Vec;
  max: Vec;
}

/// The axes of a camera, of unit length.
export interface Axes {
  right: Vec;
  up: Vec;
  forward: Vec;
}

/// The farthest distance of a camera from the box, in radii of the box.
export const farthestRadii = 40;

/// The smallest angle between view and up direction: beyond the pole, left and right would be exchanged.
const minPolarAngle = 0.01;

const boundsCentre = (bounds: Bounds): Vec => scale(add(bounds.min, bounds.max), 0.5);
export const boundsRadius = (bounds: Bounds): number => 0.5 * distance(bounds.min, bounds.max) || 1;

/// Returns the axes of a camera. They are orthogonal also where the camera has no direction.
export function cameraAxes(camera: CameraState): Axes {
  const forward = normalise(subtract(camera.target, camera.eye), [0, 0, -1]);
  const up = normalise(camera.up, [0, 1, 0]);
  const right = normalise(cross(forward, up), perpendicular(forward));
  return { right, up: cross(right, forward), forward };
}

/// Whether a picture can be drawn with a camera.
export function isUsable(camera: CameraState): boolean {
  return (
    isFinite(camera.eye) &&
    isFinite(camera.target) &&
    isFinite(camera.up) &&
    length(camera.up) > 0 &&
    distance(camera.eye, camera.target) > 0 &&
    camera.fov >= 1 &&
    camera.fov <= 160
  );
}

/// Returns the direction of the ray through a point of the picture. `x`, `y`: from -1 to 1, right and up.
export function rayDirection(camera: CameraState, aspect: number, x: number, y: number): Vec {
  const axes = cameraAxes(camera);
  const tangent = Math.tan((camera.fov * Math.PI) / 360);
  return normalise(along(along(axes.forward, axes.right, x * tangent * aspect), axes.up, y * tangent), axes.forward);
}

/// Returns half the height of what the picture shows at the distance of the camera's target.
export function halfHeight({ eye, target, fov }: CameraState): number {
  return distance(eye, target) * Math.tan((fov * Math.PI) / 360);
}

/// Returns the place from which a picture is drawn, and rays begin: the eye, or before the surface what an orthographic camera sees.
export function standpoint(camera: CameraState, bounds: Bounds): Vec {
  if (camera.orthographic !== true) return camera.eye;
  const { forward } = cameraAxes(camera);
  const depth = dot(subtract(boundsCentre(bounds), camera.eye), forward);
  return along(camera.eye, forward, depth - 2 * boundsRadius(bounds));
}

/// Returns the ray through a point of the picture. `x`, `y`: as of rayDirection().
export function rayThrough(camera: CameraState, bounds: Bounds, aspect: number, x: number, y: number): Ray {
  const origin = standpoint(camera, bounds);
  if (camera.orthographic !== true) return { origin, direction: rayDirection(camera, aspect, x, y) };
  const { right, up, forward } = cameraAxes(camera);
  const half = halfHeight(camera);
  return { origin: along(along(origin, right, x * half * aspect), up, y * half), direction: forward, isParallel: true };
}

/// Returns where a point is in the picture, as `x` and `y` of rayDirection(); null where it is beside it.
export function placeInPicture(camera: CameraState, aspect: number, point: Vec): [number, number] | null {
  const { right, up, forward } = cameraAxes(camera);
  const p = subtract(point, camera.eye);
  const half = camera.orthographic === true ? halfHeight(camera) : dot(p, forward) * Math.tan((camera.fov * Math.PI) / 360);
  const [x, y] = [dot(p, right) / (half * aspect), dot(p, up) / half];
  return half > 0 && Math.abs(x) <= 1 && Math.abs(y) <= 1 ? [x, y] : null;
}

/// Turns a camera about a pivot: by `yaw` about the up direction, and by `pitch` about the camera's right, short of the poles.
export function orbit(camera: CameraState, pivot: Vec, yaw: number, pitch: number): CameraState {
  if (!Number.isFinite(yaw) || !Number.isFinite(pitch)) return camera;
  const up = normalise(camera.up, [0, 1, 0]);
  const { right, forward } = cameraAxes(camera);
  const polar = Math.acos(Math.min(1, Math.max(-1, dot(forward, up))));
  const turned = Math.min(Math.PI - minPolarAngle, Math.max(minPolarAngle, polar - pitch));
  const turn = (a: Vec): Vec => add(pivot, rotate(rotate(subtract(a, pivot), right, polar - turned), up, yaw));
  return { ...camera, eye: turn(camera.eye), target: turn(camera.target) };
}

/// Moves eye and target along the camera's axes, by distances in units.
export function shift(camera: CameraState, right: number, up: number, forward: number): CameraState {
  if (!Number.isFinite(right + up + forward)) return camera;
  const axes = cameraAxes(camera);
  const by = along(along(scale(axes.right, right), axes.up, up), axes.forward, forward);
  return { ...camera, eye: add(camera.eye, by), target: add(camera.target, by) };
}

/// Whether a camera may move from one eye to another: not farther than farthestRadii from the surface, unless it comes nearer.
export function mayMove(from: Vec, to: Vec, bounds: Bounds): boolean {
  const middle = boundsCentre(bounds);
  const reach = distance(to, middle);
  return reach < farthestRadii * boundsRadius(bounds) || reach < distance(from, middle);
}

/// Moves a camera towards a point, until the point is `factor` times as far; until its picture is that much smaller, where the camera is
/// orthographic. The distance, there the target's, stays within [nearest, farthest], and the point stays where it is in the picture.
export function zoom(camera: CameraState, towards: Vec, factor: number, nearest: number, farthest: number): CameraState {
  const now = distance(camera.eye, camera.orthographic === true ? camera.target : towards);
  if (!(factor > 0) || !(now > 0) || !Number.isFinite(factor)) return camera;
  const then = Math.min(Math.max(now * factor, Math.min(nearest, now)), Math.max(farthest, now));
  const move = (a: Vec): Vec => along(towards, subtract(a, towards), then / now);
  return { ...camera, eye: move(camera.eye), target: move(camera.target) };
}

/// Aims a camera at a point, from the same side and distance.
export function centre(camera: CameraState, point: Vec): CameraState {
  return { ...camera, eye: add(camera.eye, subtract(point, camera.target)), target: point };
}

/// Blends two cameras. `t`: from 0, `a`, to 1, `b`. Distances change by equal factors in equal steps.
export function blend(a: CameraState, b: CameraState, t: number): CameraState {
  if (t >= 1) return b;
  const mix = (p: Vec, q: Vec): Vec => along(scale(p, 1 - t), q, t);
  const target = mix(a.target, b.target);
  const from = subtract(a.eye, a.target);
  const to = subtract(b.eye, b.target);
  const reach = length(from) ** (1 - t) * length(to) ** t;
  const direction = normalise(mix(normalise(from, [0, 0, 1]), normalise(to, [0, 0, 1])), normalise(to, [0, 0, 1]));
  return {
    ...b,
    eye: along(target, direction, reach),
    target,
    up: normalise(mix(normalise(a.up, [0, 1, 0]), normalise(b.up, [0, 1, 0])), b.up),
    fov: a.fov + (b.fov - a.fov) * t,
  };
}

/// Returns the camera whose picture a box fills, seen from the side of `camera`. The whole box is in the picture: a surface may reach
/// into any of its corners.
export function fit(camera: CameraState, bounds: Bounds, aspect: number): CameraState {
  const axes = cameraAxes(camera);
  const middle = boundsCentre(bounds);
  const margin = 0.04;
  const ty = Math.tan((camera.fov * Math.PI) / 360) * (1 - 2 * margin);
  const tx = ty * aspect;
  const widening = camera.orthographic === true ? 0 : 1; // of the picture with the depth
  // How far the eye has to be for all corners to lie within each side of the picture.
  let [left, right, below, above] = [0, 0, 0, 0];
  for (let i = 0; i < 8; ++i) {
    const corner: Vec = [i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1];
    const p = corner.map((side, k) => side * 0.5 * (bounds.max[k]! - bounds.min[k]!)) as Vec;
    const [x, y, depth] = [dot(axes.right, p), dot(axes.up, p), -widening * dot(axes.forward, p)];
    right = Math.max(right, x + tx * depth);
    left = Math.max(left, -x + tx * depth);
    above = Math.max(above, y + ty * depth);
    below = Math.max(below, -y + ty * depth);
  }
  const reach = Math.max((left + right) / (2 * tx), (below + above) / (2 * ty), 1e-6 * boundsRadius(bounds));
  const target = along(along(middle, axes.right, (right - left) / 2), axes.up, (above - below) / 2);
  return { ...camera, target, eye: along(target, axes.forward, -reach) };
}

/// Returns the distances of the near and the far plane. Surface before the near plane is not drawn, so that this plane stays well before
/// the target.
export function clipPlanes(camera: CameraState, bounds: Bounds): { near: number; far: number } {
  const radius = boundsRadius(bounds) * 1.02;
  if (camera.orthographic === true) return { near: 0.9 * radius, far: 3.1 * radius }; // from the standpoint
  const reach = distance(camera.eye, boundsCentre(bounds));
  const far = Math.max(reach + radius, 1e-3 * radius);
  // From within, nearby walls are drawn, too. A depth buffer of 32 bits still separates 1e-4 radii on the far side.
  const inside = Math.min(0.003 * radius, 0.05 * distance(camera.eye, camera.target));
  return { near: Math.max(reach - radius, inside, 2e-5 * far), far: far * 1.001 };
}
