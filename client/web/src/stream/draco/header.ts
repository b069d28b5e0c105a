// SPDX-License-Identifier: Apache-2.0
// The header of a Draco point cloud: its claims are checked before any decoder reserves memory for them.

import { badPoints } from "../decoded_points";
import { maxPoints } from "../protocol";
import { ByteReader } from "./byte_reader";

const pointsPerByte = 256; // more than any encoder reaches: 70 were measured, for 4,000,000 points of 1 bit with normals of 2
const freePoints = 65_536;
const maxBytesPerPoint = 64;
const hasMetadata = 0x8000;
const sequential = 0; // Draco's other method, a kd-tree, does not keep the order of the points
const bytesOfType = [0, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8, 1]; // by Draco's number of the data type

/// An attribute, with Draco's numbers of its kind and data type.
export interface DracoAttribute {
  kind: number;
  type: number;
  components: number;
}

// The attributes of a block.
const uint8 = 2;
const float32 = 9;
export const position: DracoAttribute = { kind: 0, type: float32, components: 3 };
export const normal: DracoAttribute = { kind: 1, type: float32, components: 3 };
export const colour: DracoAttribute = { kind: 2, type: uint8, components: 3 };
export const radius: DracoAttribute = { kind: 4, type: uint8, components: 1 };
export const blockAttributes = [position, normal, colour, radius];

/// The header of a block: it has positions, normals and radii.
export interface DracoHeader {
  points: number;
  attributes: DracoAttribute[];
  hasColours: boolean;
  size: number; // of the header, bytes
}

/// Reads the header of a block. Throws DATA_LOSS where the bytes are none, or claim more points than they can hold.
export function readHeader(bytes: Uint8Array): DracoHeader {
  const reader = new ByteReader(bytes);
  if (String.fromCharCode(...reader.take(5)) !== "DRACO") throw badPoints("no Draco data");
  const [major, minor, geometry, method] = [reader.u8(), reader.u8(), reader.u8(), reader.u8()];
  if (major !== 2 || minor > 3) throw badPoints(`Draco's version ${major}.${minor}`);
  if (geometry !== 0) throw badPoints("Draco data of no point cloud");
  if (method !== sequential) throw badPoints(`Draco's method ${method}`);
  if ((reader.u16() & hasMetadata) !== 0) throw badPoints("Draco metadata in a block");
  const points = reader.i32();
  const possible = Math.min(maxPoints, pointsPerByte * bytes.length + freePoints);
  if (points <= 0 || points > possible) throw badPoints(`Draco data of ${bytes.length} bytes claims ${points} points`);
  if (reader.u8() !== 1) throw badPoints("Draco data of several groups of attributes");
  const attributes = Array.from({ length: Math.min(reader.varint(), maxBytesPerPoint + 1) }, () => readAttribute(reader));
  const bytesPerPoint = attributes.reduce((sum, { type, components }) => sum + components * bytesOfType[type]!, 0);
  if (bytesPerPoint > maxBytesPerPoint) throw badPoints(`Draco data of ${bytesPerPoint} bytes a point`);
  for (const needed of [position, normal, radius]) {
    if (!hasAttribute(attributes, needed)) throw badPoints("Draco data that lacks an attribute");
  }
  return { points, attributes, size: reader.position, hasColours: hasAttribute(attributes, colour) };
}

/// Whether there is such an attribute, as the first of its kind. Throws DATA_LOSS where that one has another type.
function hasAttribute(attributes: readonly DracoAttribute[], { kind, type, components }: DracoAttribute): boolean {
  const found = attributes.find((a) => a.kind === kind);
  if (found === undefined) return false;
  if (found.type !== type || found.components !== components) throw badPoints("a Draco attribute of another type");
  return true;
}

function readAttribute(reader: ByteReader): DracoAttribute {
  const [kind, type, components] = [reader.u8(), reader.u8(), reader.u8()];
  reader.u8(); // whether it is normalised
  reader.varint(); // the attribute's number
  if (components === 0 || !bytesOfType[type]) throw badPoints(`a Draco attribute that is ${components} of data type ${type}`);
  return { kind, type, components };
}
