// SPDX-License-Identifier: Apache-2.0
// A worker thread that reads one file of points.

import { asCurvecastError, CurvecastError, type ErrorCode } from "../stream/errors";
import type { NamedFile } from "../stream/mesh_upload";
import type { Cloud } from "./cloud_store";
import { readCloud } from "./read_cloud";

/// The messages from the worker: any number of the first, then one of the others. It is sent the file.
export type CloudMessage = { part: number; words: string } | { cloud: Cloud } | { error: { code: ErrorCode; message: string } };

const leastPause = 50; // ms between two messages of progress

const tooLarge = "the browser has not enough memory for so many points";

let last = -Infinity;

self.onmessage = async ({ data }: MessageEvent<NamedFile>) => {
  const send = (message: CloudMessage, transfer: Transferable[] = []): void => self.postMessage(message, { transfer });
  const onProgress = (part: number, words: string): void => {
    if (performance.now() - last < leastPause) return;
    last = performance.now();
    send({ part, words });
  };
  try {
    const cloud = await readCloud(data, onProgress);
    const { positions, normals, colours } = cloud;
    send({ cloud }, [positions.buffer, normals.buffer, ...(colours === null ? [] : [colours.buffer])]);
  } catch (thrown) {
    // Arrays that do not fit are the only ranges that are exceeded.
    const isTooLarge = thrown instanceof RangeError;
    const { code, message } = isTooLarge ? new CurvecastError("RESOURCE_EXHAUSTED", tooLarge) : asCurvecastError(thrown);
    send({ error: { code, message } });
  }
};
