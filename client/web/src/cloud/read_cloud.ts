// SPDX-License-Identifier: Apache-2.0
// Reads a file of points, and makes what is drawn of it.

import type { NamedFile } from "../stream/mesh_upload";
import type { Cloud } from "./cloud_store";
import type { OnRead } from "./file_bytes";
import { readLasPoints } from "./las_points";
import { makeNeighbourDiscs } from "./neighbour_discs";
import { readPlyPoints } from "./ply_points";
import type { RawPoints } from "./raw_points";
import { readTextPoints } from "./text_points";
import { badFile } from "./words";

/// Told the share that is done, and what is being done.
export type OnProgress = (part: number, words: string) => void;

const readingShare = 0.5; // of the time

/// Reads a file by the extension of its name. Throws INVALID_ARGUMENT: what is wrong with it, and where.
export async function readCloud({ name, data }: NamedFile, onProgress: OnProgress): Promise<Cloud> {
  if (data.size === 0) throw badFile("the file is empty");
  const onRead: OnRead = (bytes) => onProgress((readingShare * bytes) / data.size, "reading");
  const raw = await readPoints(name, data, onRead);
  if (raw.count === 0) throw badFile(["there are no points in it", ...raw.notices].join(". "));
  return cloudOf(raw, (part) => onProgress(readingShare + (1 - readingShare) * part, "finding neighbours"));
}

function readPoints(name: string, data: Blob, onRead: OnRead): Promise<RawPoints> {
  if (/\.ply$/i.test(name)) return readPlyPoints(data, onRead);
  if (/\.la[sz]$/i.test(name)) return readLasPoints(data, onRead);
  return readTextPoints(data, onRead);
}

/// Makes discs of points. Precondition: there are some.
export function cloudOf(raw: RawPoints, onProgress?: (part: number) => void): Cloud {
  const { count, notices } = raw;
  const { min, max } = boxOf(raw);
  const origin = min.map((least, axis) => (least + max[axis]!) / 2) as Cloud["origin"];
  const places = new Float32Array(3 * count);
  for (let i = 0; i < places.length; ++i) places[i] = raw.positions[i]! - origin[i % 3]!;
  const { positions, normals, from } = makeNeighbourDiscs(places, raw.normals, onProgress);
  const colours = raw.colours && inOrder(raw.colours, from);
  if (min.every((least, axis) => least === max[axis])) {
    const reach = positions[3]!; // of the discs of points all at one place
    for (let axis = 0; axis < 3; ++axis) [min[axis], max[axis]] = [min[axis]! - reach, max[axis]! + reach];
  }
  return { count, origin, positions, normals, colours, min, max, notices };
}

function boxOf({ count, positions }: RawPoints): Pick<Cloud, "min" | "max"> {
  const min: Cloud["min"] = [Infinity, Infinity, Infinity];
  const max: Cloud["max"] = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < 3 * count; ++i) {
    const axis = i % 3;
    const value = positions[i]!;
    if (value < min[axis]!) min[axis] = value;
    if (value > max[axis]!) max[axis] = value;
  }
  return { min, max };
}

/// Makes 4 bytes a point of 3, in another order.
function inOrder(rgb: Uint8Array, from: Uint32Array): Uint8Array<ArrayBuffer> {
  const out = new Uint8Array(4 * from.length);
  for (let to = 0; to < from.length; ++to) {
    const at = 3 * from[to]!;
    out[4 * to] = rgb[at]!;
    out[4 * to + 1] = rgb[at + 1]!;
    out[4 * to + 2] = rgb[at + 2]!;
    out[4 * to + 3] = 255;
  }
  return out;
}
