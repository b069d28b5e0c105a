// SPDX-License-Identifier: Apache-2.0
// Shapes of lines that are drawn over the picture.

import * as THREE from "three";
import { cameraAxes, halfHeight } from "./camera_math";
import type { OverlayLine } from "./overlay_lines";
import type { Background, CameraState, Vec } from "./types";
import { along, distance } from "./vector";

const frustumColours: Record<Background, THREE.Color> = { light: new THREE.Color(0x1d5fa8), dark: new THREE.Color(0x7db8f5) };
const markColour = new THREE.Color(0x2563c9);
const measureColour = new THREE.Color(0xe0531c);

/// Makes the frustum of a camera up to its target, or the box of an orthographic one, with a roof on the side that is up.
export function frustumLines(camera: CameraState, aspect: number, background: Background): OverlayLine[] {
  const colour = frustumColours[background];
  const { eye } = camera;
  const { right, up, forward } = cameraAxes(camera);
  const reach = distance(eye, camera.target);
  const top = halfHeight(camera);
  const at = (x: number, y: number): Vec => along(along(along(eye, forward, reach), right, x * top * aspect), up, y * top);
  const line = (from: Vec, to: Vec, width: number): OverlayLine => ({ from, to, width, colour });
  const corners = [at(-1, -1), at(1, -1), at(1, 1), at(-1, 1)];
  return [
    ...corners.map((corner) => line(camera.orthographic === true ? along(corner, forward, -reach) : eye, corner, 1.4)),
    ...corners.map((corner, i) => line(corner, corners[(i + 1) % 4]!, 1.8)),
    line(at(-0.3, 1), at(0, 1.25), 1.8),
    line(at(0.3, 1), at(0, 1.25), 1.8),
    line(eye, eye, 7),
  ];
}

/// Makes a dot at each place.
export function markDots(places: readonly Vec[]): OverlayLine[] {
  return places.map((place) => ({ from: place, to: place, width: 9, colour: markColour }));
}

/// Makes the lines between points, one after the other, with a dot at each. `isClosed`: back to the first, too.
export function measureLines(points: readonly Vec[], isClosed: boolean): OverlayLine[] {
  const colour = measureColour;
  const ways = points.slice(1).map((to, i): OverlayLine => ({ from: points[i]!, to, width: 2, colour }));
  const back = isClosed && points.length > 2 ? [{ from: points.at(-1)!, to: points[0]!, width: 1, colour }] : [];
  return [...ways, ...back, ...points.map((place) => ({ from: place, to: place, width: 8, colour }))];
}
