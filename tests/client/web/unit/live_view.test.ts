import type { MessageInitShape } from "@bufbuild/protobuf";
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";

import {
  FrameKind,
  StreamViewsRequestSchema,
  StreamViewsResponseSchema,
  type PointBlock,
  type PointFrameSchema,
  type SampleRequest,
} from "../../../../client/web/src/gen/curvecast/v1/curvecast_pb";
import { badPoints, type DecodedPoints } from "../../../../client/web/src/stream/decoded_points";
import type { CurvecastError } from "../../../../client/web/src/stream/errors";
import {
  LiveView,
  type LiveViewEvents,
  type LiveViewOptions,
  type LiveViewState,
} from "../../../../client/web/src/stream/live_view";
import { Socket } from "../../../../client/web/src/stream/socket";
import type { FrameReport } from "../../../../client/web/src/stream/statistics";
import { FakeWebSocket } from "./fake_web_socket";

/// Blocks of this many points are refused.
const badCount = 13;

/// Decodes nothing; larger blocks take longer.
class FakeDecoder {
  async decode(blocks: readonly PointBlock[]): Promise<DecodedPoints[]> {
    const count = blocks.reduce((sum, block) => sum + block.count, 0);
    await new Promise((resolve) => setTimeout(resolve, count > 20 ? 20 : 0));
    if (count === badCount) throw badPoints("a bad number");
    return blocks.map((block) => ({
      count: block.count,
      origin: [0, 0, 0],
      positions: new Float32Array(4 * block.count).fill(1),
      normals: new Int8Array(4 * block.count),
      colours: null,
      curvatures: null,
      ranks: null,
      directions: null,
      scalars: [],
    }));
  }
}

interface Followed {
  view: LiveView;
  frames: FrameReport[];
  states: LiveViewState[];
  errors: (CurvecastError | null)[];
}

/// `also`: called after what is noted here.
function follow(options: LiveViewOptions = { firstDelay: 0.001, longestDelay: 0.001 }, also: LiveViewEvents = {}): Followed {
  let socket: Socket | null = null;
  const connect = () => {
    if (socket === null || socket.error !== null) socket = new Socket({ url: "ws://host", webSocket: FakeWebSocket.make });
    return socket;
  };
  const frames: FrameReport[] = [];
  const states: LiveViewState[] = [];
  const errors: (CurvecastError | null)[] = [];
  const view = new LiveView(
    connect,
    new FakeDecoder(),
    "session",
    {
      onFrame: (frame) => (frames.push(frame), also.onFrame?.(frame)),
      onState: (state, error, delay) => (states.push(state), errors.push(error), also.onState?.(state, error, delay)),
    },
    options,
  );
  return { view, frames, states, errors };
}

const points = (count: number) => ({ budget: { case: "points" as const, value: BigInt(count) } });

function push(server: FakeWebSocket, frame: MessageInitShape<typeof PointFrameSchema>, call = 1): void {
  server.respond(StreamViewsResponseSchema, { frame }, call);
}

const key = (sequence: bigint, count: number, digest = 0n) => ({
  sequence,
  kind: FrameKind.KEY,
  points: [{ count }],
  heldPoints: BigInt(count),
  digest,
});

function pointsOf(sample: SampleRequest | undefined): bigint | null {
  return sample?.budget.case === "points" ? sample.budget.value : null;
}

/// Short forms of what was sent.
function requests(server: FakeWebSocket, call = 1): string[] {
  return server.sent(StreamViewsRequestSchema, call).map(({ request }) => {
    switch (request.case) {
      case "open":
        if (request.value.held === undefined) return "open anew";
        return `open with ${request.value.held.points}/${request.value.held.digest}`;
      case "view":
        return `view ${request.value.sequence}: ${pointsOf(request.value.sample)}`;
      case "ack":
        return `ack ${request.value.sequence}`;
      default:
        return "nothing";
    }
  });
}

const server = (index = 0) => FakeWebSocket.made[index]!;

const pass = (milliseconds: number) => vi.advanceTimersByTimeAsync(milliseconds);

beforeEach(() => {
  FakeWebSocket.made = [];
  vi.useFakeTimers();
});
afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

describe("a live view", () => {
  it("connects at the first look, and acknowledges frames once their points are there", async () => {
    const { view, frames, states } = follow();
    expect(FakeWebSocket.made).toEqual([]);
    expect(view.look(points(50))).toBe(1);
    server().open();
    expect(requests(server())).toEqual(["open anew", "view 1: 50"]);
    push(server(), key(1n, 50));
    await pass(5);
    expect(requests(server()).length).toBe(2); // still decoding
    await pass(40);
    expect(requests(server())[2]).toBe("ack 1");
    expect(view.store.count).toBe(50);
    expect(frames).toMatchObject([{ sequence: 1, points: 50, added: 50, removed: 0, isDelta: false, error: null }]);
    expect(frames[0]!.viewSeconds).toBeGreaterThan(0.015);
    expect(frames[0]!.bytes).toBeGreaterThan(5);
    expect(states).toEqual(["connecting", "streaming"]);
  });

  it("takes frames in in their order, however long each takes to decode", async () => {
    const { view, frames, states } = follow();
    view.look(points(50));
    server().open();
    push(server(), { ...key(1n, 50), statistics: { refining: true, encodeSeconds: 0.25, equaliseSeconds: 0.5 } });
    push(server(), {
      sequence: 1n,
      kind: FrameKind.DELTA,
      points: [{ count: 2 }],
      edits: { removed: [0], added: [3, 1] },
      heldPoints: 51n,
    });
    await pass(50);
    expect(frames.map((frame) => [frame.points, frame.isDelta, frame.removed])).toEqual([
      [50, false, 0],
      [51, true, 1],
    ]);
    expect(frames[0]!.serverSeconds).toBe(0.75);
    expect(frames[1]!.viewSeconds).toBeNull();
    expect(states).toEqual(["connecting", "refining", "streaming"]);
    expect(requests(server()).slice(2)).toEqual(["ack 1", "ack 1"]);
    expect(view.statistics()).toMatchObject({ frames: 2, deltas: 1, viewP50: frames[0]!.viewSeconds });
  });

  it("keeps one view waiting at most, the newest", async () => {
    const { view } = follow();
    view.look(points(1));
    server().open();
    server().bufferedAmount = 1 << 20;
    for (let number = 2; number <= 100; ++number) expect(view.look(points(number))).toBe(number);
    expect(requests(server())).toEqual(["open anew", "view 1: 1"]);
    server().bufferedAmount = 0;
    await pass(40);
    expect(requests(server()).slice(2)).toEqual(["view 100: 100"]);
  });

  it("goes on from what it holds after the connection was lost, and sends the newest view again", async () => {
    const { view, frames, states, errors } = follow();
    view.look(points(5));
    server().open();
    view.look(points(6));
    push(server(), key(2n, 5, 77n));
    await pass(10);
    const lost = performance.now();
    server().lose(1006);
    await pass(1);
    expect(FakeWebSocket.made.length).toBe(2);
    expect(states).toEqual(["connecting", "streaming", "reconnecting"]);
    expect(errors.at(-1)!.code).toBe("UNAVAILABLE");
    expect(view.store.count).toBe(5);
    server(1).open();
    expect(requests(server(1))).toEqual(["open with 5/77", "view 2: 6"]);
    const { request } = server(1).sent(StreamViewsRequestSchema)[0]!;
    expect(request.case === "open" && request.value.held?.sample?.budget.value).toBe(6n);
    push(server(1), { sequence: 2n, kind: FrameKind.DELTA, edits: { removed: [4] }, heldPoints: 4n });
    await pass(10);
    expect(frames.at(-1)).toMatchObject({ points: 4, isDelta: true });
    expect(1000 * frames.at(-1)!.viewSeconds!).toBeLessThan(performance.now() - lost); // since it was sent again
    expect(states.at(-1)).toBe("streaming");
    expect(view.look(points(7))).toBe(3);
    expect(requests(server(1)).at(-1)).toBe("view 3: 7");
  });

  it("begins anew after a frame that cannot be taken in", async () => {
    const { view, states, errors } = follow();
    view.look(points(5));
    server().open();
    push(server(), key(1n, 5, 77n));
    push(server(), key(1n, badCount, 78n));
    await pass(30);
    expect(errors.find((error) => error !== null)).toMatchObject({
      code: "DATA_LOSS",
      message: expect.stringContaining("frame 1") as string,
    });
    expect(states).toEqual(["connecting", "streaming", "reconnecting"]);
    expect(server().requests.some(({ call, cancel }) => call === 1 && cancel)).toBe(true);
    expect(requests(server(), 2)).toEqual(["open anew", "view 1: 5"]); // over the same socket
    expect(view.store.count).toBe(5);
    push(server(), { sequence: 1n, kind: FrameKind.DELTA, edits: { removed: [4] }, heldPoints: 4n }, 2);
    await pass(10);
    expect(errors.at(-1)).toMatchObject({ code: "DATA_LOSS", message: expect.stringContaining("not there") as string });
  });

  it("tells of refused views, and lives on", async () => {
    const { view, frames, states } = follow();
    view.look(points(5));
    server().open();
    push(server(), key(1n, 5));
    view.look(points(0));
    push(server(), { sequence: 2n, error: { code: 8, message: "no room", retryAfter: 1.5 } });
    await pass(10);
    expect(frames.at(-1)).toMatchObject({
      sequence: 2,
      points: 5,
      error: { code: "RESOURCE_EXHAUSTED", message: "no room", retryAfter: 1.5 },
    });
    expect(states).toEqual(["connecting", "streaming"]);
    expect(requests(server()).at(-1)).toBe("ack 2");
  });

  it.each([
    [5, "NOT_FOUND"],
    [16, "UNAUTHENTICATED"],
    [3, "INVALID_ARGUMENT"],
    [8, "RESOURCE_EXHAUSTED"],
  ])("is over after status %i", async (code, name) => {
    const { view, states, errors } = follow();
    view.look(points(5));
    server().open().end(1, { code, message: "why" });
    await pass(20);
    expect(states).toEqual(["connecting", "failed"]);
    expect(errors.at(-1)).toMatchObject({ code: name, message: "why" });
    view.look(points(6));
    await pass(20);
    expect(FakeWebSocket.made.length).toBe(1);
    expect(requests(server()).length).toBe(2);
  });

  it("is over when the token is refused", async () => {
    const { view, states, errors } = follow();
    view.look(points(5));
    server().open().lose(1008, "unknown token");
    await pass(20);
    expect(states).toEqual(["connecting", "failed"]);
    expect(errors.at(-1)).toMatchObject({ code: "UNAUTHENTICATED", message: "unknown token" });
  });

  it("tries at once when it is asked to", async () => {
    const { view, states } = follow({ firstDelay: 1000, longestDelay: 1000 });
    view.look(points(5));
    server().open().lose(1006);
    await pass(20);
    expect(states.at(-1)).toBe("reconnecting");
    expect(FakeWebSocket.made.length).toBe(1);
    view.retryNow();
    expect(FakeWebSocket.made.length).toBe(2);
    view.retryNow(); // it is about to
    view.retryNow();
    expect(FakeWebSocket.made.length).toBe(2);
    expect(
      server(1)
        .open()
        .requests.filter(({ method }) => method === "StreamViews").length,
    ).toBe(1);
    view.close();
  });

  it("waits longer and longer while streams break off after their first frame, and not after one that lived", async () => {
    const delays: number[] = [];
    const onState = (_: LiveViewState, __: unknown, delay: number | null) => {
      if (delay !== null) delays.push(delay);
    };
    const { view } = follow({ firstDelay: 0.1, longestDelay: 5 }, { onState });
    view.look(points(5));
    server().open();
    for (let call = 1; call <= 8; ++call) {
      push(server(), key(1n, 5), call);
      push(server(), key(1n, badCount), call);
      await pass(5100);
    }
    expect(delays.length).toBe(8);
    expect(delays[7]).toBeGreaterThan(2.4);
    push(server(), key(1n, 5), 9);
    await pass(1500);
    server().end(9, { code: 10, message: "the session was closed" });
    await pass(10);
    expect(delays[8]).toBeLessThanOrEqual(0.1);
    view.close();
  });

  it("lives on after callbacks that throw, and reports what they do", async () => {
    const reported: unknown[] = [];
    vi.stubGlobal("reportError", (thrown: unknown) => reported.push(thrown));
    const fail = () => {
      throw new Error("of the page");
    };
    const { view, frames, states } = follow(undefined, { onFrame: fail, onState: fail });
    view.look(points(5));
    server().open();
    push(server(), key(1n, 5));
    push(server(), key(1n, 6));
    await pass(10);
    server().lose(1006);
    await pass(1);
    expect(FakeWebSocket.made.length).toBe(2);
    push(server(1).open(), key(1n, 7));
    await pass(10);
    expect(frames.map((frame) => frame.points)).toEqual([5, 6, 7]);
    expect(states).toEqual(["connecting", "streaming", "reconnecting", "streaming"]);
    expect(reported.length).toBe(7);
    view.close();
  });

  it("answers a server that repeats itself without progress later and later, and the next view at once", async () => {
    const { view, frames } = follow();
    const acks = () => requests(server()).filter((text) => text.startsWith("ack")).length;
    const same = { sequence: 1n, kind: FrameKind.DELTA, edits: {}, heldPoints: 5n, statistics: { refining: true } };
    view.look(points(5));
    server().open();
    push(server(), { ...key(1n, 5), statistics: { refining: true } });
    let pushed = 0;
    for (let i = 0; i < 10_000; ++i) {
      await pass(1);
      for (; pushed < acks(); ++pushed) push(server(), same); // as soon as the last one is acknowledged
    }
    expect(acks()).toBeGreaterThan(5);
    expect(acks()).toBeLessThan(25);
    expect(view.state).toBe("refining");
    await pass(1);
    const before = requests(server()).length;
    view.look(points(6));
    expect(requests(server()).slice(before)).toEqual(["ack 1", "view 2: 6"]);
    push(server(), { ...same, sequence: 2n });
    await pass(1);
    expect(requests(server()).at(-1)).toBe("ack 2");
    expect(frames.at(-1)).toMatchObject({ sequence: 2, points: 5, added: 0, error: null });
    view.close();
    expect(vi.getTimerCount()).toBe(0);
  });

  it("opens nothing where it is closed as it begins", () => {
    const { view } = follow(undefined, { onState: () => view.close() });
    view.look(points(5));
    expect(FakeWebSocket.made).toEqual([]);
  });

  it("says nothing after it was closed", async () => {
    const { view, frames, states } = follow();
    view.look(points(5));
    server().open();
    push(server(), key(1n, 5));
    view.close();
    await pass(20);
    expect(frames).toEqual([]);
    expect(states).toEqual(["connecting"]);
    expect(server().requests.at(-1)!.cancel).toBe(true);
  });
});
