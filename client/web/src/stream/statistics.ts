// SPDX-License-Identifier: Apache-2.0
// What frames cost, measured by the client.

import type { PointLimit } from "../gen/curvecast/v1/curvecast_pb";
import type { CurvecastError } from "./errors";

/// A frame that was applied, or that says why its view was refused. Seconds and bytes.
export interface FrameReport {
  sequence: number; // of the view, as look() returned it
  isDelta: boolean;
  points: number; // in the store after the frame
  wantedPoints: number; // that the view's budget comes to; 0 of a budget in bytes
  limit: PointLimit; // why there are fewer
  added: number;
  removed: number;
  resized: number;
  bytes: number; // of the whole message on the socket
  /// From sending the view to its points in the store. Null for all but the first frame of a view.
  viewSeconds: number | null;
  serverSeconds: number; // density, sampling and encoding
  decodeSeconds: number; // from the message's arrival to decoded points, waiting for a free thread included
  storeSeconds: number; // applying the points to the store
  refining: boolean; // better points are to follow
  curveRevision: number;
  curveVertices: number;
  error: CurvecastError | null; // why the view was refused; the points are those of the frame before
}

/// Sums over a stream. Seconds and bytes.
export interface StatisticsSummary {
  frames: number;
  deltas: number;
  bytes: number;
  bytesPerSecond: number; // over the last 5 s, or since the first frame where that is sooner
  viewP50: number | null; // view sent -> points in the store, of the last 200 views that were answered
  viewP99: number | null;
  last: FrameReport | null; // the last frame without error
}

const viewsKept = 200;
const rateSeconds = 5;
const minSeconds = 1; // a rate is an average over at least so long

/// Returns the smallest value that at least the share `q` of `values` does not exceed; null of no values.
export function quantile(values: readonly number[], q: number): number | null {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted[Math.max(0, Math.ceil(q * sorted.length) - 1)] ?? null;
}

/// Sums up frames. Times are seconds of any one clock.
export class Statistics {
  private frames = 0;
  private deltas = 0;
  private bytes = 0;
  private views: number[] = [];
  private begin: number | null = null; // when the first frame came
  private recent: { time: number; bytes: number }[] = [];
  private last: FrameReport | null = null;

  add(frame: FrameReport, time: number): void {
    this.begin ??= time;
    this.bytes += frame.bytes;
    this.recent.push({ time, bytes: frame.bytes });
    this.forget(time);
    if (frame.error !== null) return;
    this.frames += 1;
    this.deltas += frame.isDelta ? 1 : 0;
    this.last = frame;
    if (frame.viewSeconds === null) return;
    this.views.push(frame.viewSeconds);
    if (this.views.length > viewsKept) this.views.shift();
  }

  summary(time: number): StatisticsSummary {
    this.forget(time);
    const seconds = Math.min(Math.max(time - (this.begin ?? time), minSeconds), rateSeconds);
    return {
      frames: this.frames,
      deltas: this.deltas,
      bytes: this.bytes,
      bytesPerSecond: this.recent.reduce((sum, { bytes }) => sum + bytes, 0) / seconds,
      viewP50: quantile(this.views, 0.5),
      viewP99: quantile(this.views, 0.99),
      last: this.last,
    };
  }

  private forget(time: number): void {
    while (this.recent.length > 0 && this.recent[0]!.time <= time - rateSeconds) this.recent.shift();
  }
}
