// The start of a Draco point cloud: what it claims is checked before a decoder takes memory for it.

import { badPoints, mostPoints } from "./decoded_points";

const pointsPerByte = 256; // 70 were measured, for 4,000,000 points at 1 bit and normals at 2
const freePoints = 65_536;
const sequential = 0;
const hasMetadata = 0x8000;
const headerBytes = 11;

/// How many points a block's Draco data claims. Throws where it is none, or claims more than can be there.
export function claimedPoints(bytes: Uint8Array): number {
  if (bytes.length < headerBytes + 4 || String.fromCharCode(...bytes.subarray(0, 5)) !== "DRACO")
    throw badPoints("no Draco data");
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const [major, minor, geometry, method] = [view.getUint8(5), view.getUint8(6), view.getUint8(7), view.getUint8(8)];
  if (major !== 2 || minor > 3) throw badPoints(`Draco's version ${major}.${minor}`);
  if (geometry !== 0) throw badPoints("Draco data of no point cloud");
  if (method !== sequential) throw badPoints(`Draco's method ${method}`);
  if ((view.getUint16(9, true) & hasMetadata) !== 0) throw badPoints("Draco metadata in a block");
  const points = view.getInt32(headerBytes, true);
  const possible = Math.min(mostPoints, pointsPerByte * bytes.length + freePoints);
  if (points <= 0 || points > possible) throw badPoints(`Draco data of ${bytes.length} bytes claims ${points} points`);
  return points;
}
