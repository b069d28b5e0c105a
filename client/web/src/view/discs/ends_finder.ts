// SPDX-License-Identifier: Apache-2.0
// Has the places where discs end found on a worker thread.

import type { EndsRequest, EndsResponse } from "./ends_worker";

/// Ends, and the positions that they were found for.
export type FoundEnds = Pick<EndsResponse, "ends" | "positions">;

export interface EndsFinder {
  /// Takes the arrays of a store's first slots. Resolves with null where the worker has failed, or was stopped.
  find(request: Omit<EndsRequest, "job">): Promise<FoundEnds | null>;
}

/// One thread for all stores.
export class WorkerEndsFinder implements EndsFinder {
  private worker: Worker | null = null;
  private readonly jobs = new Map<number, (found: FoundEnds | null) => void>();
  private lastJob = 0;

  find(request: Omit<EndsRequest, "job">): Promise<FoundEnds | null> {
    return new Promise((resolve) => {
      const job = ++this.lastJob;
      this.jobs.set(job, resolve);
      this.worker ??= this.makeWorker();
      const transfer = [request.positions.buffer, request.normals.buffer];
      this.worker.postMessage({ job, ...request } satisfies EndsRequest, transfer);
    });
  }

  /// Ends the thread. find() starts it again.
  stop(): void {
    this.worker?.terminate();
    this.worker = null;
    const jobs = [...this.jobs.values()];
    this.jobs.clear();
    for (const resolve of jobs) resolve(null);
  }

  private makeWorker(): Worker {
    const worker = new Worker(new URL("./ends_worker.ts", import.meta.url), { type: "module", name: "curvecast-disc-ends" });
    worker.onmessage = (event: MessageEvent<EndsResponse>) => {
      const { job, ...found } = event.data;
      this.jobs.get(job)?.(found);
      this.jobs.delete(job);
    };
    worker.onerror = (event) => {
      event.preventDefault(); // pictures without it are whole
      this.stop();
    };
    return worker;
  }
}
