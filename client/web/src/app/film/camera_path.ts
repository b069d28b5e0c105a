// SPDX-License-Identifier: Apache-2.0
// The way of a film's camera: a turn about what it looks at, or past views that were kept.

import type { CameraState, Vec } from "../../view";
import { add, normalise, rotate, scale, subtract } from "../../view/vector";

/// Returns a camera that has gone a share (0 .. 1) of a whole turn about its target, to the right. Where it looks from right above
/// its picture turns.
export function turned(camera: CameraState, share: number): CameraState {
  const axis = normalise(camera.up, [0, 1, 0]);
  const angle = 2 * Math.PI * share;
  return { ...camera, eye: add(camera.target, rotate(subtract(camera.eye, camera.target), axis, angle)) };
}

/// Returns the camera at a share (0 .. 1) of the way past all views, each as far from the next in time. It starts and ends at rest,
/// and goes through the views without a stop: a Catmull-Rom spline of eyes and targets. Precondition: there are two views at least.
export function passing(views: readonly CameraState[], share: number): CameraState {
  const eased = share * share * (3 - 2 * share);
  const at = Math.min(Math.max(eased, 0), 1) * (views.length - 1);
  const first = Math.min(Math.floor(at), views.length - 2);
  const t = at - first;
  const around = [-1, 0, 1, 2].map((step) => views[Math.min(Math.max(first + step, 0), views.length - 1)]!);
  const [from, to] = [around[1]!, around[2]!];
  const mixed = (of: (view: CameraState) => Vec): Vec => spline(around.map(of), t);
  return {
    ...(t < 0.5 ? from : to), // what has nothing between: the projection
    eye: mixed(({ eye }) => eye),
    target: mixed(({ target }) => target),
    up: normalise(
      mixed(({ up }) => up),
      from.up,
    ),
    fov: from.fov + t * (to.fov - from.fov),
  };
}

/// A Catmull-Rom spline between the second and the third of four places.
function spline(places: readonly Vec[], t: number): Vec {
  const weights = [((2 - t) * t - 1) * t, (3 * t - 5) * t * t + 2, ((4 - 3 * t) * t + 1) * t, (t - 1) * t * t];
  return places.reduce<Vec>((sum, place, i) => add(sum, scale(place, weights[i]! / 2)), [0, 0, 0]);
}
