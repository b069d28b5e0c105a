// SPDX-License-Identifier: Apache-2.0
// Keeps a mesh up to date with the density that the page shows.

import { asCurvecastError, type CurvecastError, type RemeshOptions, type TriangleMesh } from "../stream";
import { bytesOf, sameBytes, type SampleInit } from "./sample_request";

/// Callbacks, called one at a time. They may call follow().
export interface MeshEvents {
  /// There is another mesh; null: none any more.
  onMesh(mesh: TriangleMesh | null): void;
  /// The newest mesh could not be made. The one before stays.
  onFailure(error: CurvecastError): void;
}

const strokeRelaxations = 1; // while the brush paints: the next mesh is about to come
const quiet = 150; // ms without a change before a mesh is asked for, unless the brush paints

interface Wanted {
  sample: SampleInit;
  bytes: Uint8Array;
  isPainting: boolean;
}

/// Asks for one mesh at a time. The newest density wins: a mesh that is overtaken is cancelled, and never queued. Only during a stroke
/// of the brush, which changes the density faster than meshes are made, each mesh is finished before the next, so that some are seen.
export class MeshFollower {
  private shown: TriangleMesh | null = null;
  private wanted: Wanted | null = null;
  private asked: { wanted: Wanted; stop: AbortController } | null = null;
  private answered: Wanted | null = null; // with a mesh, or with an error
  private lastSeconds = 0;
  private timer: ReturnType<typeof setTimeout> | undefined;

  constructor(
    private readonly remesh: (sample: SampleInit, options: RemeshOptions) => Promise<TriangleMesh>,
    private readonly events: MeshEvents,
  ) {}

  /// The newest mesh that has come.
  get mesh(): TriangleMesh | null {
    return this.shown;
  }

  /// Whether the mesh is the one that was wanted last, as far as it could be made.
  get isCurrent(): boolean {
    return this.answered === this.wanted;
  }

  /// Seconds that the mesh took, from the request to the answer.
  get seconds(): number {
    return this.lastSeconds;
  }

  /// Wants a mesh of a sample; null: none. `isPainting`: a stroke of the brush is under way.
  follow(sample: SampleInit | null, isPainting: boolean): void {
    if (sample === null) return this.drop();
    const wanted = { sample, bytes: bytesOf(sample), isPainting };
    const isFinished = isPainting || this.wanted?.isPainting === false; // a mesh of the same sample need not be more regular
    if (this.wanted !== null && isFinished && sameBytes(wanted.bytes, this.wanted.bytes)) return;
    this.wanted = wanted;
    clearTimeout(this.timer);
    if (this.asked !== null && !(isPainting && this.asked.wanted.isPainting)) this.cancel();
    if (this.asked !== null) return; // its answer asks for the next
    if (isPainting) void this.ask(wanted);
    else this.timer = setTimeout(() => void this.ask(wanted), quiet);
  }

  /// Ends all, without a callback.
  close(): void {
    clearTimeout(this.timer);
    this.cancel();
    this.wanted = this.answered = this.shown = null;
  }

  private drop(): void {
    const hadMesh = this.shown !== null;
    this.close();
    if (hadMesh) this.events.onMesh(null);
  }

  private cancel(): void {
    const { asked } = this;
    this.asked = null;
    asked?.stop.abort();
  }

  private async ask(wanted: Wanted): Promise<void> {
    const stop = new AbortController();
    const asked = (this.asked = { wanted, stop });
    const begin = performance.now();
    let result: TriangleMesh | CurvecastError;
    try {
      const options = wanted.isPainting ? { relaxations: strokeRelaxations } : {};
      result = await this.remesh(wanted.sample, { ...options, signal: stop.signal });
    } catch (thrown) {
      result = asCurvecastError(thrown);
    }
    if (this.asked !== asked) return; // cancelled
    this.asked = null;
    this.answered = wanted;
    if (this.wanted !== null && this.wanted !== wanted) void this.ask(this.wanted);
    if (result instanceof Error) return this.events.onFailure(result);
    this.shown = result;
    this.lastSeconds = (performance.now() - begin) / 1000;
    this.events.onMesh(result);
  }
}
