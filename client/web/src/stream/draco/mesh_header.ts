// SPDX-License-Identifier: Apache-2.0
// The header of a Draco mesh: its claims are checked before any decoder reserves memory for them.

import { CurvecastError } from "../errors";
import { ByteReader } from "./byte_reader";

const mesh = 1;
const edgebreaker = 1; // Draco's other method lists the triangles
const hasMetadata = 0x8000;
const trianglesPerByte = 512; // as the points of a cloud: more than any encoder reaches
const freeTriangles = 65_536;

/// Makes the error for a surface that cannot be used: DATA_LOSS.
export function badSurface(why: string): CurvecastError {
  return new CurvecastError("DATA_LOSS", `the server sent a bad surface: ${why}`);
}

/// Throws DATA_LOSS where the bytes are no mesh of so many triangles and at most so many vertices, or cannot hold as many.
export function checkMeshHeader(bytes: Uint8Array, vertices: number, triangles: number): void {
  const reader = new ByteReader(bytes);
  if (String.fromCharCode(...reader.take(5)) !== "DRACO") throw badSurface("no Draco data");
  const [major, minor, geometry, method] = [reader.u8(), reader.u8(), reader.u8(), reader.u8()];
  if (major !== 2 || minor !== 2) throw badSurface(`Draco's version ${major}.${minor}`);
  if (geometry !== mesh) throw badSurface("Draco data of no mesh");
  if (method !== edgebreaker) throw badSurface(`Draco's method ${method}`);
  if ((reader.u16() & hasMetadata) !== 0) throw badSurface("Draco metadata");
  reader.u8(); // how the triangles are walked over
  const [claimedVertices, claimedTriangles] = [reader.varint(), reader.varint()];
  // Draco has further vertices where surfaces meet in one: these count when it has read them.
  if (claimedTriangles !== triangles || claimedVertices > vertices) {
    throw badSurface(`Draco data of ${claimedTriangles} triangles and ${claimedVertices} vertices`);
  }
  if (triangles > trianglesPerByte * bytes.length + freeTriangles) {
    throw badSurface(`Draco data of ${bytes.length} bytes claims ${triangles} triangles`);
  }
}
