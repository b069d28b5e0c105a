import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";

import {
  CurvecastService,
  GetSessionResponseSchema,
  ListSessionsRequestSchema,
  ListSessionsResponseSchema,
} from "../../../../client/web/src/gen/curvecast/v1/curvecast_pb";
import type { CurvecastError } from "../../../../client/web/src/stream/errors";
import { ReconnectingSocket } from "../../../../client/web/src/stream/reconnecting_socket";
import { Socket } from "../../../../client/web/src/stream/socket";
import { FakeWebSocket } from "./fake_web_socket";

const { getSession } = CurvecastService.method;
const endpoint = { url: "ws://host/v1/socket", webSocket: FakeWebSocket.make };

function connect(): [Socket, FakeWebSocket] {
  const socket = new Socket(endpoint);
  return [socket, FakeWebSocket.made.at(-1)!];
}

/// A call that nobody answers; how it ended.
function ask(socket: Socket): { error: CurvecastError | null } {
  const end: { error: CurvecastError | null } = { error: null };
  socket.unary(getSession, {}).catch((error: unknown) => (end.error = error as CurvecastError));
  return end;
}

const probes = (server: FakeWebSocket) => server.requests.filter(({ method }) => method === "ListSessions").map(({ call }) => call);
const pass = (seconds: number) => vi.advanceTimersByTimeAsync(1000 * seconds);

/// What is sent waits from then on. `then`: told how much.
function holdBack(server: FakeWebSocket, then: (length: number) => void = () => {}): void {
  const send = server.send.bind(server);
  server.send = (bytes) => {
    send(bytes);
    server.bufferedAmount += bytes.length;
    then(bytes.length);
  };
}

beforeEach(() => {
  FakeWebSocket.made = [];
  vi.useFakeTimers();
});
afterEach(() => void vi.useRealTimers());

describe("a socket on which nothing is heard", () => {
  it("asks once, and is lost where nothing answers", async () => {
    const [socket, server] = connect();
    const end = ask(socket);
    server.open();
    await pass(14);
    expect(probes(server)).toEqual([]);
    await pass(2);
    expect(probes(server)).toEqual([2]);
    expect(server.sent(ListSessionsRequestSchema, 2)).toMatchObject([{ pageSize: 1 }]);
    await pass(8);
    expect(end.error).toBeNull();
    await pass(2);
    expect(end.error).toMatchObject({ code: "UNAVAILABLE", message: "the server does not answer" });
    expect(probes(server)).toEqual([2]);
    expect(server.isClosed).toBe(true);
    expect(socket.error).toBe(end.error);
    expect(vi.getTimerCount()).toBe(0);
  });

  it("is lost, too, where the system still takes what is sent", async () => {
    const [socket, server] = connect();
    const end = ask(socket);
    server.open();
    holdBack(server, (length) => setTimeout(() => (server.bufferedAmount -= length), 100));
    await pass(27);
    expect(end.error?.code).toBe("UNAVAILABLE");
  });

  it("lives on with any answer", async () => {
    const [socket, server] = connect();
    const end = ask(socket);
    server.open();
    await pass(20);
    server.respond(ListSessionsResponseSchema, {}, 2);
    server.end(2);
    await pass(10);
    expect(probes(server)).toEqual([2]);
    await pass(8);
    expect(probes(server)).toEqual([2, 3]);
    server.respond(GetSessionResponseSchema, {}, 77); // of a call that was cancelled
    await pass(10);
    expect(end.error).toBeNull();
  });

  it("is left alone while what waits to be sent becomes less", async () => {
    const [socket, server] = connect();
    server.open();
    holdBack(server);
    server.bufferedAmount = 1000;
    const end = ask(socket);
    for (let i = 0; i < 10; ++i) {
      await pass(10);
      server.bufferedAmount -= 10;
    }
    const upload = socket.start(CurvecastService.method.uploadMesh, { onMessage: () => {}, onEnd: () => {} });
    for (let i = 0; i < 10; ++i) {
      await pass(10);
      const before = server.bufferedAmount;
      upload.send({});
      server.bufferedAmount = before; // as much has left
    }
    expect(probes(server)).toEqual([]);
    await pass(30);
    expect(end.error?.code).toBe("UNAVAILABLE");
  });

  it("is not watched without calls", async () => {
    const [socket, server] = connect();
    server.open();
    expect(vi.getTimerCount()).toBe(0);
    const call = socket.unary(getSession, {});
    expect(vi.getTimerCount()).toBe(1);
    server.respond(GetSessionResponseSchema, {});
    server.end();
    await call;
    expect(vi.getTimerCount()).toBe(0);
    await pass(100);
    const end = ask(socket);
    await pass(10); // the time without calls does not count
    expect(probes(server)).toEqual([]);
    socket.close();
    await pass(0);
    expect(end.error?.code).toBe("CANCELLED");
    expect(vi.getTimerCount()).toBe(0);
  });

  it("is lost where it does not even open", async () => {
    const [socket, server] = connect();
    const end = ask(socket);
    await pass(27);
    expect(end.error).toMatchObject({ code: "UNAVAILABLE", message: "the server cannot be reached" });
    expect(server.isClosed).toBe(true);
    expect(socket.timedOut).toBe(false);
  });
});

describe("a page that stood still", () => {
  /// As a timer sees it that was held up for so long.
  const sleep = (seconds: number) => vi.setSystemTime(Date.now() + 1000 * seconds);
  beforeEach(() => void vi.spyOn(performance, "now").mockImplementation(() => Date.now()));
  afterEach(() => void vi.restoreAllMocks());

  it("asks before it takes the server for lost, and again where its question is as old", async () => {
    const [socket, server] = connect();
    const end = ask(socket);
    server.open();
    await pass(3);
    sleep(3600);
    await pass(1);
    expect(probes(server)).toEqual([2]);
    sleep(3600);
    await pass(1);
    expect(probes(server)).toEqual([2, 3]);
    expect(end.error).toBeNull();
    server.end(2); // had come meanwhile
    await pass(14);
    expect(end.error).toBeNull();
    await pass(12);
    expect(end.error?.code).toBe("UNAVAILABLE");
  });

  it("notices it even where its timers are slow", async () => {
    const [socket, server] = connect();
    const end = ask(socket);
    server.open();
    for (let i = 0; i < 3; ++i) {
      expect(end.error).toBeNull();
      sleep(60);
      await pass(1);
    }
    expect(end.error?.code).toBe("UNAVAILABLE");
  });
});

describe("a connection", () => {
  it("is the more patient with the next socket where one fell silent, until one is lost otherwise", async () => {
    const connection = new ReconnectingSocket(endpoint);
    const server = () => FakeWebSocket.made.at(-1)!;
    for (const idleTimeout of [15, 30, 60, 120, 120]) {
      const end = ask(connection.socket());
      server().open();
      await pass(idleTimeout + 8);
      expect(end.error).toBeNull();
      await pass(4);
      expect(end.error).not.toBeNull();
    }
    ask(connection.socket());
    server().lose(1006);
    const end = ask(connection.socket());
    server().open();
    await pass(27);
    expect(end.error).not.toBeNull();
    expect(FakeWebSocket.made.length).toBe(7);
  });
});
