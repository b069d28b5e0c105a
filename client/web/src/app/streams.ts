// The streams of a page: the one that is looked at, and beside it one of even density where the picture is split.

import { create, toBinary } from "@bufbuild/protobuf";

import {
  SampleRequestSchema,
  type Client,
  type CurvecastError,
  type FrameReport,
  type LiveView,
  type LiveViewState,
} from "../stream";
import type { SampleInit } from "./sample_request";

/// The stream that is looked at, or the one beside it.
export type Which = "main" | "uniform";

/// Of both; as those of LiveView.
export interface StreamsEvents {
  onFrame(frame: FrameReport): void;
  onState(which: Which, state: LiveViewState, error: CurvecastError | null, delay: number | null): void;
}

const firstBytes = 48 << 10; // something shows as soon as these have come

function sameBytes(a: Uint8Array, b: Uint8Array): boolean {
  return a.length === b.length && a.every((byte, i) => byte === b[i]);
}

/// A view that is asked only for what is new.
class DistinctView {
  private last: Uint8Array = new Uint8Array(0);

  constructor(readonly view: LiveView) {}

  /// Whether it was new.
  look(sample: SampleInit): boolean {
    const bytes = toBinary(SampleRequestSchema, create(SampleRequestSchema, sample));
    if (this.view.lastLook > 0 && sameBytes(bytes, this.last)) return false;
    this.last = bytes;
    this.view.look(sample);
    return true;
  }
}

/// Of one session.
export class Streams {
  private readonly mainView: DistinctView;
  private uniformView: DistinctView | null = null;

  constructor(
    private readonly client: Client,
    readonly sessionId: string,
    private readonly events: StreamsEvents,
  ) {
    this.mainView = this.open("main");
  }

  /// The stream that is looked at.
  get main(): LiveView {
    return this.mainView.view;
  }

  /// The one beside it; null where there is none.
  get uniform(): LiveView | null {
    return this.uniformView?.view ?? null;
  }

  /// Whether there is one beside it.
  split(on: boolean): void {
    if (on === (this.uniformView !== null)) return;
    this.uniformView?.view.close();
    this.uniformView = on ? this.open("uniform") : null;
  }

  /// Of both, over the last seconds.
  get bytesPerSecond(): number {
    return this.main.statistics().bytesPerSecond + (this.uniform?.statistics().bytesPerSecond ?? 0);
  }

  /// Those that are reconnecting do not wait any longer.
  retryNow(): void {
    this.main.retryNow();
    this.uniform?.retryNow();
  }

  /// `uniform`: what the one beside it is to show. Returns whether points for `sample` are about to come.
  look(sample: SampleInit, uniform: SampleInit): boolean {
    this.uniformView?.look(uniform);
    const { state } = this.main;
    return this.mainView.look(sample) && (state === "streaming" || state === "refining");
  }

  close(): void {
    this.mainView.view.close();
    this.uniformView?.view.close();
  }

  private open(which: Which): DistinctView {
    const { events } = this;
    const handlers = {
      onFrame: (frame: FrameReport) => events.onFrame(frame),
      onState: (...how: [LiveViewState, CurvecastError | null, number | null]) => events.onState(which, ...how),
    };
    return new DistinctView(this.client.view(this.sessionId, handlers, { firstBytes }));
  }
}
