// SPDX-License-Identifier: Apache-2.0
// Decodes the blocks of frames, and surfaces, on worker threads.

import type { PointBlock } from "../gen/curvecast/v1/curvecast_pb";
import { BlockDecoder, buffersOf, encodedBlock, NeedsLibrary, type EncodedBlock } from "./block_decoder";
import type { DecodeRequest, DecodeResponse } from "./decode_worker";
import { badPoints, type DecodedPoints } from "./decoded_points";
import { asCurvecastError, CurvecastError } from "./errors";
import { maxPoints } from "./protocol";
import type { EncodedSurface, SurfaceMesh } from "./decoded_surface";

const fewPoints = 4096; // decoding them on this thread is faster than a message to another thread and back

/// Turns the blocks of a message into points. Rejects with a CurvecastError; later calls are not affected.
export interface PointDecoder {
  decode(blocks: readonly PointBlock[]): Promise<DecodedPoints[]>;
}

/// Turns the file of a surface into triangles, too.
export interface Decoder extends PointDecoder {
  decodeSurface(surface: EncodedSurface): Promise<SurfaceMesh>;
}

type Task = { block: EncodedBlock } | { surface: EncodedSurface };

interface Job {
  worker: Worker;
  resolve(decoded: DecodedPoints | SurfaceMesh): void;
  reject(error: CurvecastError): void;
}

/// Decodes on worker threads, and small frames on the calling thread. Any number of streams may share one decoder.
export class WorkerDecoder implements Decoder {
  private workers: { worker: Worker; load: number }[] = []; // load: points or triangles that the worker has yet to decode
  private readonly jobs = new Map<number, Job>();
  private lastJob = 0;
  private readonly here = new BlockDecoder(null); // draco3d is on the workers alone
  private isClosed = false;

  constructor(private readonly threads = 2) {
    this.fill();
  }

  async decode(blocks: readonly PointBlock[]): Promise<DecodedPoints[]> {
    if (this.isClosed) throw closed();
    const total = blocks.reduce((sum, block) => sum + block.count, 0);
    if (total > maxPoints) throw badPoints(`${total} in a frame`);
    return Promise.all(blocks.map((block) => this.decodeBlock(encodedBlock(block), total <= fewPoints)));
  }

  async decodeSurface(surface: EncodedSurface): Promise<SurfaceMesh> {
    if (this.isClosed) throw closed();
    return (await this.run({ surface }, surface.triangles)) as SurfaceMesh;
  }

  /// Ends the threads. Rejects blocks that are being decoded, and later ones, as CANCELLED.
  close(): void {
    this.isClosed = true;
    for (const { worker } of this.workers) worker.terminate();
    this.workers = [];
    const jobs = [...this.jobs.values()];
    this.jobs.clear();
    for (const job of jobs) job.reject(closed());
  }

  private async decodeBlock(block: EncodedBlock, isHere: boolean): Promise<DecodedPoints> {
    if (isHere) {
      try {
        return await this.here.decode(block);
      } catch (thrown) {
        if (!(thrown instanceof NeedsLibrary)) throw thrown;
        if (this.isClosed) throw closed();
      }
    }
    return (await this.run({ block }, block.count)) as DecodedPoints;
  }

  private run(task: Task, load: number): Promise<DecodedPoints | SurfaceMesh> {
    return new Promise((resolve, reject) => {
      this.fill();
      const least = this.workers.reduce((best, other) => (other.load < best.load ? other : best));
      const job = ++this.lastJob;
      const done = () => {
        this.jobs.delete(job);
        least.load -= load;
      };
      least.load += load;
      this.jobs.set(job, {
        worker: least.worker,
        resolve: (decoded) => (done(), resolve(decoded)),
        reject: (error) => (done(), reject(error)),
      });
      const request: DecodeRequest = { job, ...task };
      least.worker.postMessage(request, buffersOf("block" in task ? task.block : task.surface));
    });
  }

  private fill(): void {
    while (this.workers.length < this.threads) this.workers.push({ worker: this.makeWorker(), load: 0 });
  }

  private makeWorker(): Worker {
    const worker = new Worker(new URL("./decode_worker.ts", import.meta.url), { type: "module", name: "curvecast-decoder" });
    worker.onmessage = (event: MessageEvent<DecodeResponse>) => {
      const response = event.data;
      const job = this.jobs.get(response.job);
      if ("points" in response) job?.resolve(response.points);
      else if ("surface" in response) job?.resolve(response.surface);
      else job?.reject(new CurvecastError(response.error.code, response.error.message));
    };
    worker.onerror = (event) => {
      event.preventDefault();
      this.replace(worker, asCurvecastError(event.error ?? event.message ?? "a thread of the decoder failed"));
    };
    return worker;
  }

  /// Drops a worker that failed as a whole, and rejects its blocks. The next block gets a new worker.
  private replace(worker: Worker, error: CurvecastError): void {
    worker.terminate();
    this.workers = this.workers.filter((other) => other.worker !== worker);
    for (const job of [...this.jobs.values()]) {
      if (job.worker === worker) job.reject(new CurvecastError("DATA_LOSS", error.message));
    }
  }
}

function closed(): CurvecastError {
  return new CurvecastError("CANCELLED", "the decoder was closed");
}
