// A worker thread that decodes blocks of points.

import { BlockDecoder, buffersOf, type EncodedBlock } from "./block_decoder";
import type { DecodedPoints } from "./decoded_points";
import { asCurvecastError, type ErrorCode } from "./errors";

/// The messages to the worker and back.
export interface DecodeRequest {
  job: number;
  block: EncodedBlock;
}
export type DecodeResponse = { job: number; points: DecodedPoints } | { job: number; error: { code: ErrorCode; message: string } };

const decoder = new BlockDecoder();

self.onmessage = async (event: MessageEvent<DecodeRequest>) => {
  const { job, block } = event.data;
  let response: DecodeResponse;
  try {
    response = { job, points: await decoder.decode(block) };
  } catch (thrown) {
    const { code, message } = asCurvecastError(thrown);
    response = { job, error: { code, message } };
  }
  self.postMessage(response, { transfer: "points" in response ? buffersOf(response.points) : [] });
};
