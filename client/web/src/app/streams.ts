// SPDX-License-Identifier: Apache-2.0
// The streams of a page: the main one, and in a split view one of uniform density beside it.

import type { Client, CurvecastError, FrameReport, LiveView, LiveViewState, Session } from "../stream";
import { bytesOf, sameBytes, type SampleInit } from "./sample_request";

/// The main stream, whose density the user sets, or the one of uniform density.
export type Which = "main" | "uniform";

/// The events of both streams, as those of LiveView.
export interface StreamsEvents {
  onFrame(frame: FrameReport): void;
  onState(which: Which, state: LiveViewState, error: CurvecastError | null, delay: number | null): void;
}

const firstBytes = 48 << 10; // of a frame, that come first and are shown at once

/// Asks a view only for samples that differ from the last one.
class DistinctView {
  private last: Uint8Array = new Uint8Array(0);

  constructor(readonly view: LiveView) {}

  /// Asks for a sample. Returns whether it differed from the last one.
  look(sample: SampleInit): boolean {
    const bytes = bytesOf(sample);
    if (this.view.lastLook > 0 && sameBytes(bytes, this.last)) return false;
    this.last = bytes;
    this.view.look(sample);
    return true;
  }
}

/// The streams of one session.
export class Streams {
  private readonly mainView: DistinctView;
  private uniformView: DistinctView | null = null;

  constructor(
    private readonly client: Client,
    private readonly session: Session,
    private readonly events: StreamsEvents,
  ) {
    this.mainView = this.open("main");
  }

  get sessionId(): string {
    return this.session.sessionId;
  }

  /// The main stream.
  get main(): LiveView {
    return this.mainView.view;
  }

  /// The stream of uniform density; null without a split view.
  get uniform(): LiveView | null {
    return this.uniformView?.view ?? null;
  }

  /// Opens or closes the stream of uniform density.
  split(on: boolean): void {
    if (on === (this.uniformView !== null)) return;
    this.uniformView?.view.close();
    this.uniformView = on ? this.open("uniform") : null;
  }

  /// Bytes a second of both streams, over the last seconds.
  get bytesPerSecond(): number {
    return this.main.statistics().bytesPerSecond + (this.uniform?.statistics().bytesPerSecond ?? 0);
  }

  /// Whether all points of the newest views are there.
  get isAnswered(): boolean {
    return [this.main, this.uniform].every((view) => view === null || view.statistics().last?.sequence === view.lastLook);
  }

  /// Lets streams that wait before they reconnect do so now.
  retryNow(): void {
    this.main.retryNow();
    this.uniform?.retryNow();
  }

  /// Asks the main stream for `sample`, and the other one for `uniform`. Returns whether points for `sample` are about to come.
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
    const { sessionId, options, report } = this.session;
    const creaseDegrees = options?.creaseDegrees ?? report?.mesh?.creaseDegrees;
    return new DistinctView(
      this.client.view(sessionId, handlers, { firstBytes, ...(creaseDegrees !== undefined && { creaseDegrees }) }),
    );
  }
}
