// SPDX-License-Identifier: Apache-2.0
// The plane that cuts the surface open.

import type { Bounds } from "./camera_math";
import type { Section, Vec } from "./types";
import { dot } from "./vector";

/// Returns the plane across an axis of a box. `share`: of the box that stays, from 0 to 1; `isOther`: at the other end of the axis.
export function sectionOf(axis: "x" | "y" | "z", share: number, isOther: boolean, { min, max }: Bounds): Section {
  const k = "xyz".indexOf(axis);
  const sign = isOther ? -1 : 1;
  const normal = [0, 1, 2].map((i) => (i === k ? sign : 0)) as Vec;
  const [from, to] = isOther ? [max[k]!, min[k]!] : [min[k]!, max[k]!];
  return { normal, offset: sign * (from + share * (to - from)) };
}

/// Returns normal and offset for positions relative to an origin. Without a plane, nothing is beyond it.
export function localSection(section: Section | null, origin: readonly number[]): [number, number, number, number] {
  if (section === null) return [0, 0, 0, 1];
  return [...section.normal, section.offset - dot(section.normal, origin as Vec)];
}
