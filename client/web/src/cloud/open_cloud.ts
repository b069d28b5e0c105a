// SPDX-License-Identifier: Apache-2.0
// Has a file of points read on a worker thread of its own.

import { asCurvecastError, cancelled, CurvecastError } from "../stream/errors";
import type { NamedFile } from "../stream/mesh_upload";
import type { Cloud } from "./cloud_store";
import type { CloudMessage } from "./cloud_worker";
import type { OnProgress } from "./read_cloud";

/// How to follow the reading, and how to stop it.
export interface CloudOptions {
  onProgress?: OnProgress;
  signal?: AbortSignal;
}

/// Reads a file of points. Rejects with INVALID_ARGUMENT: what is wrong with it and where; RESOURCE_EXHAUSTED where the memory does not
/// suffice; CANCELLED.
export function openCloud(file: NamedFile, { onProgress, signal }: CloudOptions = {}): Promise<Cloud> {
  return new Promise<Cloud>((resolve, reject) => {
    if (signal?.aborted === true) return reject(cancelled());
    const worker = new Worker(new URL("./cloud_worker.ts", import.meta.url), { type: "module", name: "curvecast-cloud" });
    const stop = (): void => end(() => reject(cancelled()));
    const end = (how: () => void): void => {
      worker.terminate();
      signal?.removeEventListener("abort", stop);
      how();
    };
    signal?.addEventListener("abort", stop);
    worker.onmessage = ({ data }: MessageEvent<CloudMessage>) => {
      if ("part" in data) onProgress?.(data.part, data.words);
      else if ("cloud" in data) end(() => resolve(data.cloud));
      else end(() => reject(new CurvecastError(data.error.code, data.error.message)));
    };
    worker.onerror = (event) => {
      event.preventDefault();
      end(() => reject(asCurvecastError(event.error ?? event.message ?? "the thread that reads it failed")));
    };
    worker.postMessage(file);
  });
}
