// SPDX-License-Identifier: Apache-2.0
// A worker thread that decodes blocks of points, and surfaces.

import { BlockDecoder, buffersOf, type EncodedBlock } from "./block_decoder";
import type { DecodedPoints } from "./decoded_points";
import { DracoLibrary } from "./draco/library";
import { asCurvecastError, type ErrorCode } from "./errors";
import type { EncodedSurface, SurfaceMesh } from "./decoded_surface";
import { decodeSurface } from "./surface_decoder";

/// The messages to the worker and back.
export type DecodeRequest = { job: number } & ({ block: EncodedBlock } | { surface: EncodedSurface });
export type DecodeResponse = { job: number } & (
  { points: DecodedPoints } | { surface: SurfaceMesh } | { error: { code: ErrorCode; message: string } }
);

const decoder = new BlockDecoder(new DracoLibrary());

self.onmessage = async ({ data }: MessageEvent<DecodeRequest>) => {
  const { job } = data;
  let response: DecodeResponse;
  try {
    if ("block" in data) response = { job, points: await decoder.decode(data.block) };
    else response = { job, surface: await decodeSurface(data.surface) };
  } catch (thrown) {
    const { code, message } = asCurvecastError(thrown);
    response = { job, error: { code, message } };
  }
  const decoded = "points" in response ? response.points : "surface" in response ? response.surface : null;
  self.postMessage(response, { transfer: decoded === null ? [] : buffersOf(decoded) });
};
