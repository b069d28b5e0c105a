// SPDX-License-Identifier: Apache-2.0
// Finds the surface's own triangles under the pointer by a search through all of them: Möller, Trumbore, "Fast, minimum storage
// ray/triangle intersection", Journal of Graphics Tools 1997. A million of them take about 20 ms.

import type { SurfaceMesh } from "../stream/decoded_surface";
import { localSection } from "./section";
import type { Pick, Ray, Section, Vec } from "./types";
import { along, normalise } from "./vector";

/// Finds where a ray first meets a triangle. Ignores what is nearer than `near`, and what `section` cuts off. `radius`: of the pick.
export function pickSurface(
  { positions, normals, triangles, origin }: SurfaceMesh,
  ray: Ray,
  near: number,
  radius: number,
  section: Section | null = null,
): Pick | null {
  const [dx, dy, dz] = ray.direction;
  const [ox, oy, oz] = [ray.origin[0] - origin[0], ray.origin[1] - origin[1], ray.origin[2] - origin[2]];
  const [sx, sy, sz, offset] = localSection(section, origin);
  let front = Infinity;
  let found = -1;
  let [foundU, foundV] = [0, 0];
  for (let at = 0; at < triangles.length; at += 3) {
    const a = 3 * triangles[at]!,
      b = 3 * triangles[at + 1]!,
      c = 3 * triangles[at + 2]!;
    const ax = positions[a]!,
      ay = positions[a + 1]!,
      az = positions[a + 2]!;
    const px = positions[b]! - ax,
      py = positions[b + 1]! - ay,
      pz = positions[b + 2]! - az;
    const qx = positions[c]! - ax,
      qy = positions[c + 1]! - ay,
      qz = positions[c + 2]! - az;
    const hx = dy * qz - dz * qy,
      hy = dz * qx - dx * qz,
      hz = dx * qy - dy * qx;
    const volume = px * hx + py * hy + pz * hz;
    if (volume === 0) continue;
    const ex = ox - ax,
      ey = oy - ay,
      ez = oz - az;
    const u = (ex * hx + ey * hy + ez * hz) / volume;
    if (!(u >= 0 && u <= 1)) continue;
    const kx = ey * pz - ez * py,
      ky = ez * px - ex * pz,
      kz = ex * py - ey * px;
    const v = (dx * kx + dy * ky + dz * kz) / volume;
    if (!(v >= 0 && u + v <= 1)) continue;
    const t = (qx * kx + qy * ky + qz * kz) / volume;
    if (!(t >= near && t < front)) continue;
    if (sx * (ox + t * dx) + sy * (oy + t * dy) + sz * (oz + t * dz) > offset) continue;
    front = t;
    found = at;
    foundU = u;
    foundV = v;
  }
  if (found < 0) return null;
  const weights = [1 - foundU - foundV, foundU, foundV];
  let normal: Vec = [0, 0, 0];
  for (let k = 0; k < 3; ++k) {
    const corner = 3 * triangles[found + k]!;
    normal = along(normal, [normals[corner]!, normals[corner + 1]!, normals[corner + 2]!], weights[k]!);
  }
  return { point: along(ray.origin, ray.direction, front), normal: normalise(normal, [0, 0, 1]), radius };
}
