// SPDX-License-Identifier: Apache-2.0
// A stream of views into a store, which is opened again when it breaks off.

import { create, type MessageInitShape } from "@bufbuild/protobuf";

import {
  CurvecastService,
  FrameKind,
  PointLimit,
  SampleRequestSchema,
  type FrameStatistics,
  type PointFrame,
  type SampleRequest,
  type StreamViewsRequestSchema,
  type StreamViewsResponse,
  type StreamViewsResponseSchema,
} from "../gen/curvecast/v1/curvecast_pb";
import { AckThrottle } from "./ack_throttle";
import { Backoff } from "./backoff";
import type { Call } from "./call";
import { callBack } from "./call_back";
import { now } from "./clock";
import type { DecodedPoints } from "./decoded_points";
import type { PointDecoder } from "./decoder";
import { asCurvecastError, boundedDelay, codeName, CurvecastError } from "./errors";
import { StreamedPoints, type PointDifference } from "./point_store";
import type { Socket } from "./socket";
import { Statistics, type FrameReport, type StatisticsSummary } from "./statistics";

/// connecting: the first look() opens the stream. streaming: the store has the points of the newest view, or of one just before it.
/// refining: the same, and the server makes better points. reconnecting: the stream broke off and is opened again in a moment; the
/// points stay. failed: the stream is not opened again.
export type LiveViewState = "connecting" | "streaming" | "refining" | "reconnecting" | "failed";

/// Callbacks, called one at a time. They may call look() and close(). What they throw is reported as an error of the page.
export interface LiveViewEvents {
  /// A frame is in the store, or the server has refused a view: see FrameReport.error.
  onFrame?(frame: FrameReport): void;
  /// The state has changed. `error`: why it is reconnecting or has failed. `delay`: seconds until it reconnects.
  onState?(state: LiveViewState, error: CurvecastError | null, delay: number | null): void;
}

export interface LiveViewOptions {
  deltas?: boolean; // default: true
  firstBytes?: number; // as ViewUpdate.first_bytes; default: 0, frames come whole
  creaseDegrees?: number; // of the session's edges, for PointStore.creaseDegrees; default: 40
  firstDelay?: number; // seconds before a broken stream is opened again; doubles until a stream lives for a second; default: 0.1
  longestDelay?: number; // seconds; a server that asks for a longer one gets it; default: 5
}

type ViewCall = Call<typeof StreamViewsRequestSchema, typeof StreamViewsResponseSchema>;
type Decoded = { points: DecodedPoints[]; seconds: number } | CurvecastError;

interface SentView {
  sequence: number;
  sample: SampleRequest;
  time: number | null; // when it was sent; null once a frame has answered it
}

const maxRemembered = 256; // views; a frame of an older view is shown, but a new stream cannot resume from it
const maxBuffered = 64 << 10; // bytes; while more wait in the browser, the newest view waits here and can be overtaken
const secondsBetweenTries = 0.01;
const healthySeconds = 1; // that a stream lives after its first frame, for the pauses to begin anew

/// Whether a stream that ended with `error` is worth opening again. FAILED_PRECONDITION comes from a server that was restarted and
/// prepares the session anew.
function mayPass(error: CurvecastError): boolean {
  return (
    ["UNAVAILABLE", "CANCELLED", "ABORTED", "DEADLINE_EXCEEDED", "DATA_LOSS", "FAILED_PRECONDITION"].includes(error.code) ||
    (error.code === "RESOURCE_EXHAUSTED" && error.retryAfter !== null)
  );
}

function secondsOf(statistics: FrameStatistics | undefined): number {
  return statistics === undefined ? 0 : statistics.densitySeconds + statistics.equaliseSeconds + statistics.encodeSeconds;
}

/// Follows the views of a session. Acknowledges each frame once its points are in the store. The newest view wins: a view that is
/// overtaken gets no frame.
export class LiveView {
  readonly store = new StreamedPoints();
  state: LiveViewState = "connecting";
  error: CurvecastError | null = null; // why it is reconnecting or has failed

  private readonly counted = new Statistics();
  private readonly acks = new AckThrottle((sequence) => this.call?.send({ request: { case: "ack", value: { sequence } } }));
  private readonly backoff: Backoff;
  private readonly deltas: boolean;
  private readonly firstBytes: bigint;
  private newest: SampleRequest | null = null;
  private looks = 0; // the number of the newest view
  private sent = 0; // the number of the view last sent over this stream
  private views: SentView[] = [];
  private resumable: { sample: SampleRequest; digest: bigint } | null = null; // the points in the store, as a new stream names them
  private hasBase = false; // the store has the points that deltas of this stream refer to
  private firstFrameAt: number | null = null; // when the first frame of this stream was in the store
  private call: ViewCall | null = null;
  private socket: Socket | null = null;
  private accepted: Promise<void> = Promise.resolve(); // resolves once all frames so far are in the store, in their order
  private timer: ReturnType<typeof setTimeout> | null = null;
  private closed = false;

  /// `connect` returns a socket that is open or opening: a new one after the last was lost. `onOver` is called once the view is closed
  /// or has failed.
  constructor(
    private readonly connect: () => Socket,
    private readonly decoder: PointDecoder,
    readonly sessionId: string,
    private readonly events: LiveViewEvents = {},
    options: LiveViewOptions = {},
    private readonly onOver: (view: LiveView) => void = () => {},
  ) {
    this.deltas = options.deltas ?? true;
    if (options.creaseDegrees !== undefined) this.store.creaseDegrees = options.creaseDegrees;
    this.firstBytes = BigInt(options.firstBytes ?? 0);
    this.backoff = new Backoff(options.firstDelay ?? 0.1, options.longestDelay ?? 5);
  }

  /// Asks for a view. Returns the number of the view: 1, 2 ...
  look(sample: MessageInitShape<typeof SampleRequestSchema>): number {
    if (this.closed) return this.looks;
    this.newest = create(SampleRequestSchema, sample);
    this.looks += 1;
    if (this.call !== null) this.sendNewest();
    else if (this.looks === 1) this.open();
    return this.looks;
  }

  /// The number of the newest view; 0 before the first.
  get lastLook(): number {
    return this.looks;
  }

  statistics(): StatisticsSummary {
    return this.counted.summary(now());
  }

  /// Reconnects now instead of after the pause.
  retryNow(): void {
    if (this.state !== "reconnecting" || this.closed) return;
    this.backoff.reset();
    if (this.call === null) this.open(); // else the next attempt is under way
  }

  /// Ends the stream. The points stay in the store. No callback is called any more.
  close(): void {
    this.leave();
    this.stopTimer();
    this.acks.stop();
    this.call?.cancel();
    this.call = null;
  }

  private open(): void {
    this.stopTimer();
    if (this.state !== "reconnecting") this.setState("connecting"); // a stream that reconnects does so until a frame comes
    if (this.closed) return;
    const socket = this.connect();
    this.socket = socket;
    this.hasBase = this.resumable !== null;
    this.firstFrameAt = null;
    this.sent = 0;
    this.views = []; // the stream before does not answer them any more
    const call: ViewCall = socket.start(CurvecastService.method.streamViews, {
      onMessage: (response, bytes) => this.receive(call, response, bytes),
      onEnd: (error) => this.afterFrames(() => this.ended(call, error)),
    });
    this.call = call;
    call.send({
      request: {
        case: "open",
        value: {
          sessionId: this.sessionId,
          acceptDeltas: this.deltas,
          ...(this.resumable !== null && { held: { ...this.resumable, points: BigInt(this.store.count) } }),
        },
      },
    });
    this.sendNewest();
  }

  /// Sends the newest view, or tries again in a moment where the socket takes no more. At most one view waits.
  private sendNewest(): void {
    if (this.call === null || this.newest === null || this.sent === this.looks) return;
    if (this.timer !== null) return;
    if (this.socket !== null && this.socket.bufferedBytes > maxBuffered) {
      this.timer = setTimeout(() => {
        this.timer = null;
        this.sendNewest();
      }, 1000 * secondsBetweenTries);
      return;
    }
    this.acks.flush();
    this.sent = this.looks;
    this.views.push({ sequence: this.sent, sample: this.newest, time: now() });
    if (this.views.length > maxRemembered) this.views.shift();
    this.call.send({
      request: { case: "view", value: { sequence: BigInt(this.sent), sample: this.newest, firstBytes: this.firstBytes } },
    });
  }

  /// Begins to decode a frame at once. Frames may be decoded in any order; they are accepted in that of the stream.
  private receive(call: ViewCall, { frame }: StreamViewsResponse, bytes: number): void {
    if (frame === undefined) return;
    const arrival = now();
    const decoded: Promise<Decoded> = this.decoder
      .decode(frame.error === undefined ? frame.points : [])
      .then((points) => ({ points, seconds: now() - arrival }), asCurvecastError);
    this.afterFrames(async () => {
      const result = await decoded;
      if (this.call === call) this.accept(call, frame, result, bytes);
    });
  }

  private afterFrames(then: () => void | Promise<void>): void {
    this.accepted = this.accepted.then(then);
  }

  private accept(call: ViewCall, frame: PointFrame, decoded: Decoded, bytes: number): void {
    const sequence = Number(frame.sequence);
    const view = this.viewOf(sequence);
    const start = now();
    let difference: PointDifference = { added: 0, removed: 0, resized: 0 };
    if (frame.error === undefined) {
      try {
        difference = this.apply(frame, decoded);
      } catch (thrown) {
        this.resumable = null;
        const error = asCurvecastError(thrown);
        call.cancel(); // the call would end as CANCELLED, which says less than this error
        return this.ended(call, new CurvecastError(error.code, `frame ${sequence}: ${error.message}`));
      }
      this.hasBase = true;
      this.resumable = view !== null && frame.digest !== 0n ? { sample: view.sample, digest: frame.digest } : null;
    }
    const refining = frame.statistics?.refining ?? false;
    const isIdle = refining && difference.added + difference.removed + difference.resized === 0;
    this.acks.acknowledge(frame.sequence, isIdle);
    const end = now();
    const report: FrameReport = {
      sequence,
      ...difference,
      bytes,
      isDelta: frame.kind === FrameKind.DELTA,
      points: this.store.count,
      wantedPoints: Number(frame.statistics?.wantedPoints ?? 0n),
      limit: frame.statistics?.limit ?? PointLimit.UNSPECIFIED,
      viewSeconds: view?.time == null ? null : end - view.time,
      serverSeconds: secondsOf(frame.statistics),
      decodeSeconds: decoded instanceof CurvecastError ? 0 : decoded.seconds,
      storeSeconds: end - start,
      refining,
      curveRevision: Number(frame.curveRevision),
      curveVertices: Number(frame.statistics?.curveVertices ?? 0n),
      error:
        frame.error === undefined
          ? null
          : new CurvecastError(codeName(frame.error.code), frame.error.message, boundedDelay(frame.error.retryAfter)),
    };
    if (view !== null) view.time = null;
    this.counted.add(report, end);
    this.firstFrameAt ??= end;
    const state = report.refining ? "refining" : "streaming";
    if (state !== this.state) this.setState(state);
    if (!this.closed) callBack(() => this.events.onFrame?.(report));
  }

  private apply(frame: PointFrame, decoded: Decoded): PointDifference {
    if (decoded instanceof CurvecastError) throw decoded;
    if (frame.kind === FrameKind.KEY) return this.store.replace(decoded.points);
    if (frame.kind !== FrameKind.DELTA) throw new CurvecastError("DATA_LOSS", `kind ${frame.kind} is not known`);
    if (!this.hasBase) throw new CurvecastError("DATA_LOSS", "a delta to points that are not there");
    if (frame.edits === undefined) throw new CurvecastError("DATA_LOSS", "a delta without edits");
    return this.store.edit(frame.edits, decoded.points, Number(frame.heldPoints));
  }

  /// Returns the view that a frame answers, and forgets older views. Returns null where the view itself is forgotten.
  private viewOf(sequence: number): SentView | null {
    while (this.views.length > 0 && this.views[0]!.sequence < sequence) this.views.shift();
    return this.views[0]?.sequence === sequence ? this.views[0] : null;
  }

  private ended(call: ViewCall, error: CurvecastError | null): void {
    if (this.closed || this.call !== call) return;
    this.call = null;
    this.stopTimer();
    this.acks.stop();
    if (this.firstFrameAt !== null && now() - this.firstFrameAt >= healthySeconds) this.backoff.reset();
    const why = error ?? new CurvecastError("ABORTED", "the server has ended the stream");
    if (!mayPass(why)) {
      this.leave();
      return this.setState("failed", why);
    }
    const delay = Math.max(this.backoff.next(), why.retryAfter ?? 0);
    this.timer = setTimeout(() => this.open(), 1000 * delay);
    this.setState("reconnecting", why, delay);
  }

  private setState(state: LiveViewState, error: CurvecastError | null = null, delay: number | null = null): void {
    this.state = state;
    this.error = error;
    callBack(() => this.events.onState?.(state, error, delay));
  }

  private leave(): void {
    if (this.closed) return;
    this.closed = true;
    this.onOver(this);
  }

  private stopTimer(): void {
    if (this.timer !== null) clearTimeout(this.timer);
    this.timer = null;
  }
}
