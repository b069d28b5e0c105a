// SPDX-License-Identifier: Apache-2.0
// A worker thread that finds where discs end.

import { findDiscEnds, type DiscEnds } from "./disc_ends";

/// The messages to the worker and back, which return the positions.
export interface EndsRequest {
  job: number;
  positions: Float32Array<ArrayBuffer>;
  normals: Int8Array<ArrayBuffer>;
  scale: number;
  creaseDegrees: number;
}
export interface EndsResponse {
  job: number;
  ends: DiscEnds;
  positions: Float32Array<ArrayBuffer>;
}

self.onmessage = (event: MessageEvent<EndsRequest>) => {
  const { job, positions, normals, scale, creaseDegrees } = event.data;
  const ends = findDiscEnds(positions, normals, positions.length / 4, scale, creaseDegrees);
  const transfer = [ends.slots.buffer, ends.planes.buffer, ends.bends.buffer, positions.buffer];
  self.postMessage({ job, ends, positions } satisfies EndsResponse, { transfer });
};
