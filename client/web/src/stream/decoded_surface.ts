// SPDX-License-Identifier: Apache-2.0
// A surface's own triangles, before and after they are decoded.

/// The triangles of a surface. Vertices at creases are there once for each of their normals.
export interface SurfaceMesh {
  readonly origin: [number, number, number]; // units; positions are relative to it
  readonly positions: Float32Array<ArrayBuffer>; // 3 each
  readonly normals: Float32Array<ArrayBuffer>; // 3 each, of unit length
  readonly colours: Uint8Array<ArrayBuffer> | null; // 3 each
  readonly triangles: Uint32Array<ArrayBuffer>; // 3 each: vertices, counter-clockwise seen from outside
  readonly bytes: number; // of the file
}

/// A file in the form that goes to a worker, and what was said about it.
export interface EncodedSurface {
  file: Uint8Array<ArrayBuffer>;
  vertices: number;
  triangles: number;
  origin: [number, number, number];
  creaseDegrees: number;
}
