// SPDX-License-Identifier: Apache-2.0
// Finds the surface under the pointer by a search through all points, which takes about a millisecond for 100,000 of them.

import type { PointStore } from "../stream/point_store";
import { localSection } from "./section";
import type { Pick, Ray, Section, Vec } from "./types";
import { add, along, normalise } from "./vector";

/// Returns the distance along a ray to the disc in a slot; NaN where the ray misses it. `x`, `y`, `z`: the ray's origin relative to the
/// store's.
function discDistance(store: PointStore, slot: number, x: number, y: number, z: number, direction: Vec, scale: number): number {
  const { positions, normals } = store;
  const at = 4 * slot;
  const radius = positions[at + 3]! * scale;
  const [dx, dy, dz] = [positions[at]! - x, positions[at + 1]! - y, positions[at + 2]! - z];
  let [nx, ny, nz] = [normals[at]!, normals[at + 1]!, normals[at + 2]!];
  if (nx === 0 && ny === 0 && nz === 0) [nx, ny, nz] = direction; // drawn facing the eye
  const facing = nx * direction[0] + ny * direction[1] + nz * direction[2];
  if (facing === 0) return NaN;
  const t = (nx * dx + ny * dy + nz * dz) / facing;
  const [ex, ey, ez] = [t * direction[0] - dx, t * direction[1] - dy, t * direction[2] - dz];
  return ex * ex + ey * ey + ez * ez <= radius * radius ? t : NaN;
}

/// Finds the surface where a ray first hits a disc: the mean of the discs that lie together there, as in the picture. A ray that hits no
/// disc finds the point nearest to it within `tolerance` (tangent of an angle; a length where rays are parallel), and among equally near ones the nearest to the eye.
/// Ignores discs nearer than `near`, and those that `section` cuts off. Radii are multiplied by `scale`.
export function pick(
  store: PointStore,
  ray: Ray,
  near: number,
  tolerance: number,
  scale = 1,
  section: Section | null = null,
): Pick | null {
  const { positions, normals, slots, origin } = store;
  const { direction } = ray;
  const [x, y, z] = [ray.origin[0] - origin[0], ray.origin[1] - origin[1], ray.origin[2] - origin[2]];
  const [sx, sy, sz, offset] = localSection(section, origin);
  const hits: number[] = [];
  let front = Infinity;
  let frontReach = 0;
  let nearest = -1;
  let nearestScore = Infinity;
  for (let slot = 0, at = 0; slot < slots; ++slot, at += 4) {
    const radius = positions[at + 3]! * scale;
    if (!(radius > 0) || sx * positions[at]! + sy * positions[at + 1]! + sz * positions[at + 2]! > offset) continue;
    const dx = positions[at]! - x;
    const dy = positions[at + 1]! - y;
    const dz = positions[at + 2]! - z;
    const t = dx * direction[0] + dy * direction[1] + dz * direction[2];
    if (t < near) continue;
    const away = dx * dx + dy * dy + dz * dz - t * t;
    if (away <= radius * radius) {
      const hit = discDistance(store, slot, x, y, z, direction, scale);
      if (hit >= near) {
        hits.push(slot, hit);
        if (hit < front) {
          front = hit;
          frontReach = radius;
        }
        continue;
      }
    }
    const reach = tolerance * (ray.isParallel === true ? 1 : t);
    const angle = Math.max(away, 0) / (reach * reach);
    // A point twice as far away from the eye has to be much nearer to the ray.
    if (angle <= 1 && (angle + 0.25) * t < nearestScore) {
      nearestScore = (angle + 0.25) * t;
      nearest = slot;
    }
  }
  const pointAt = (slot: number): Vec =>
    add([positions[4 * slot]!, positions[4 * slot + 1]!, positions[4 * slot + 2]!], [...origin]);
  const normalAt = (slot: number): Vec => {
    const n: Vec = [normals[4 * slot]!, normals[4 * slot + 1]!, normals[4 * slot + 2]!];
    const isBack = n[0] * direction[0] + n[1] * direction[1] + n[2] * direction[2] > 0;
    return isBack && !store.isSurface ? [-n[0], -n[1], -n[2]] : n;
  };
  if (front === Infinity) {
    if (nearest < 0) return null;
    return { point: pointAt(nearest), normal: normalise(normalAt(nearest), [0, 0, 1]), radius: positions[4 * nearest + 3]! };
  }
  let weights = 0;
  let distance = 0;
  let normal: Vec = [0, 0, 0];
  let middle = -1;
  let middleWeight = -1;
  for (let i = 0; i < hits.length; i += 2) {
    const [slot, hit] = [hits[i]!, hits[i + 1]!];
    if (hit > front + frontReach) continue;
    const radius = positions[4 * slot + 3]! * scale;
    const [dx, dy, dz] = [positions[4 * slot]! - x, positions[4 * slot + 1]! - y, positions[4 * slot + 2]! - z];
    const [ex, ey, ez] = [hit * direction[0] - dx, hit * direction[1] - dy, hit * direction[2] - dz];
    const weight = 1e-3 + Math.max(0, 1 - (ex * ex + ey * ey + ez * ez) / (radius * radius)) ** 3;
    weights += weight;
    distance += weight * hit;
    normal = along(normal, normalAt(slot), weight);
    if (weight > middleWeight) [middle, middleWeight] = [slot, weight];
  }
  return {
    point: along(ray.origin, direction, distance / weights),
    normal: normalise(normal, normalise(normalAt(middle), [0, 0, 1])),
    radius: positions[4 * middle + 3]!,
  };
}
