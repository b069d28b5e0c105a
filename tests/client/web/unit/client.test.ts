import { create } from "@bufbuild/protobuf";
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";

import {
  CreateSessionRequestSchema,
  CreateSessionResponseSchema,
  ListMeshReferencesResponseSchema,
  ListSessionsResponseSchema,
  PointBlockSchema,
  UploadMeshRequestSchema,
  UploadMeshResponseSchema,
} from "../../../../client/web/src/gen/curvecast/v1/curvecast_pb";
import { Client } from "../../../../client/web/src/stream/client";
import { WorkerDecoder, type Decoder } from "../../../../client/web/src/stream/decoder";
import { CurvecastError } from "../../../../client/web/src/stream/errors";
import type { LiveViewState } from "../../../../client/web/src/stream/live_view";
import { FakeWebSocket } from "./fake_web_socket";

const file = { name: "a.off", data: new Blob([new Uint8Array(600 << 10).fill(7)]) };
const points = (count: number) => ({ budget: { case: "points" as const, value: BigInt(count) } });

const decoder: Decoder = {
  decode: () => Promise.resolve([]),
  decodeSurface: () => Promise.reject(new CurvecastError("UNIMPLEMENTED", "not in these tests")),
};

function makeClient(): Client {
  return new Client({ url: "ws://host", webSocket: FakeWebSocket.make, decoder });
}

/// What a promise comes to, once it has.
function follow<T>(promise: Promise<T>): { value: T | null; error: CurvecastError | null } {
  const outcome: { value: T | null; error: CurvecastError | null } = { value: null, error: null };
  promise.then(
    (value) => (outcome.value = value),
    (error: unknown) => {
      expect(error).toBeInstanceOf(CurvecastError);
      outcome.error = error as CurvecastError;
    },
  );
  return outcome;
}

const server = (index = 0) => FakeWebSocket.made[index]!;
const newest = () => FakeWebSocket.made.at(-1)!;
const pass = (seconds: number) => vi.advanceTimersByTimeAsync(1000 * seconds);

/// Passes time, for no longer than this, until something has happened; files are read in a time that is not faked.
async function until(happened: () => boolean, seconds = 60): Promise<void> {
  for (let i = 0; i < 100 * seconds && !happened(); ++i) {
    await pass(0.01);
    await new Promise((resolve) => setImmediate(resolve));
  }
  expect(happened()).toBe(true);
}

beforeEach(() => {
  FakeWebSocket.made = [];
  vi.useFakeTimers({ toFake: ["setTimeout", "clearTimeout", "setInterval", "clearInterval", "performance"] });
});
afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

describe("a client that was closed", () => {
  it("is so for good: its views and uploads end, nothing comes back, and later calls are refused", async () => {
    const client = makeClient();
    const states: LiveViewState[] = [];
    const view = client.view("session", { onState: (state) => states.push(state) });
    view.look(points(5));
    server().open();
    const list = follow(client.listSessions());
    const upload = follow(client.upload(file));
    await until(() => FakeWebSocket.made.length === 2 && server(1).open().requests.length > 1);
    client.close();
    client.close();
    await pass(100);
    view.look(points(6));
    expect(list.error?.code).toBe("CANCELLED");
    expect(upload.error?.code).toBe("CANCELLED");
    expect(states).toEqual(["connecting"]);
    expect(FakeWebSocket.made.map(({ isClosed }) => isClosed)).toEqual([true, true]);

    const refused = { code: "CANCELLED", message: "the client was closed" };
    const later = [client.listSessions(), client.getSession("a"), client.createSession({ meshId: "a" }), client.upload(file)];
    for (const call of [...later, client.resample("a", points(1)), client.remesh("a", points(1))])
      await expect(call).rejects.toMatchObject(refused);
    expect(() => client.view("session")).toThrow(refused.message);
    expect(FakeWebSocket.made.length).toBe(2);
    expect(vi.getTimerCount()).toBe(0);
  });

  it("ends an upload that waits to be repeated", async () => {
    const client = makeClient();
    const upload = follow(client.upload(file));
    await until(() => FakeWebSocket.made.length === 1);
    newest().lose(1006);
    await pass(0);
    client.close();
    await pass(10);
    expect(upload.error).toMatchObject({ code: "CANCELLED", message: "the client was closed" });
    expect(FakeWebSocket.made.length).toBe(1);
  });

  it("forgets views that are over", () => {
    const client = makeClient();
    const kept = () => [...(client as unknown as { closing: Set<unknown> }).closing].length;
    const before = kept();
    for (let i = 0; i < 5; ++i) client.view("session").close();
    expect(kept()).toBe(before);
  });

  it("has a decoder without threads", async () => {
    const made: { terminated: boolean }[] = [];
    vi.stubGlobal(
      "Worker",
      class {
        terminated = false;
        constructor() {
          made.push(this);
        }
        postMessage() {}
        terminate() {
          this.terminated = true;
        }
      },
    );
    const client = new Client({ url: "ws://host", webSocket: FakeWebSocket.make });
    expect(made.length).toBe(2);
    const shared = new WorkerDecoder(1);
    const another = new Client({ url: "ws://host", webSocket: FakeWebSocket.make, decoder: shared });
    const block = create(PointBlockSchema, { count: 10_000, data: { case: "raw", value: {} } });
    const decoding = follow(shared.decode([block]));
    client.close();
    another.close();
    await pass(0);
    expect(made.map(({ terminated }) => terminated)).toEqual([true, true, false]);
    expect(decoding.error).toBeNull();
    shared.close();
    await pass(0);
    expect(decoding.error?.code).toBe("CANCELLED");
    for (const blocks of [[block], []]) await expect(shared.decode(blocks)).rejects.toMatchObject({ code: "CANCELLED" });
    expect(made.length).toBe(3);
  });
});

describe("a server that repeats itself", () => {
  it("is not asked for sessions again and again", async () => {
    const sessions = follow(makeClient().listSessions());
    newest().open();
    for (let call = 1; call <= 2; ++call) {
      newest().respond(ListSessionsResponseSchema, { nextPageToken: "next" }, call);
      newest().end(call);
      await pass(0);
    }
    expect(sessions.error).toMatchObject({ code: "DATA_LOSS" });
    expect(newest().requests.length).toBe(2);
  });

  it("is not sent what a mesh refers to again and again", async () => {
    const upload = follow(makeClient().upload({ ...file, name: "a.obj" }, [{ ...file, name: "a.mtl" }]));
    await until(() => FakeWebSocket.made.length === 1);
    newest().open();
    for (let call = 1; call <= 4; ++call) {
      await until(() => newest().requests.some((request) => request.call === call && request.halfClose));
      if (call % 2 === 1) newest().respond(UploadMeshResponseSchema, { meshId: `file ${call}` }, call);
      else newest().respond(ListMeshReferencesResponseSchema, { missing: ["a.mtl"] }, call);
      newest().end(call);
    }
    await until(() => upload.value !== null);
    expect(upload.value).toEqual({ meshId: "file 1", companions: { "a.mtl": "file 3" }, missing: ["a.mtl"] });
  });
});

describe("an empty file", () => {
  it("is no mesh, which is said before anything is sent", async () => {
    const upload = follow(makeClient().upload({ name: "a.off", data: new Blob() }));
    await until(() => upload.error !== null);
    expect(upload.error).toMatchObject({ code: "INVALID_ARGUMENT", message: "the file a.off is empty" });
    expect(FakeWebSocket.made.flatMap(({ requests }) => requests)).toEqual([]);
  });

  it("is as good as missing where a mesh refers to it", async () => {
    const upload = follow(makeClient().upload({ ...file, name: "a.obj" }, [{ name: "a.mtl", data: new Blob() }]));
    await until(() => FakeWebSocket.made.length === 1);
    newest().open();
    await until(() => newest().requests.some((request) => request.call === 1 && request.halfClose));
    newest().respond(UploadMeshResponseSchema, { meshId: "mesh" }, 1);
    newest().end(1);
    await until(() => newest().requests.some((request) => request.call === 2 && request.halfClose));
    newest().respond(ListMeshReferencesResponseSchema, { missing: ["a.mtl"] }, 2);
    newest().end(2);
    await until(() => upload.value !== null);
    expect(upload.value).toEqual({ meshId: "mesh", companions: {}, missing: ["a.mtl"] });
  });
});

describe("a session that is prepared", () => {
  it("is joined again after the connection was lost", async () => {
    const client = makeClient();
    const stages: string[] = [];
    const session = follow(client.createSession({ meshId: "m", onProgress: ({ stage }) => stages.push(stage) }));
    const progress = (stage: string) =>
      newest().respond(CreateSessionResponseSchema, { update: { case: "progress", value: { stage } } });
    newest().open();
    await pass(0);
    progress("read");
    newest().lose(1006);
    await until(() => FakeWebSocket.made.length === 2);
    newest().lose(1006);
    await until(() => FakeWebSocket.made.length === 3);
    newest().open();
    expect(newest().sent(CreateSessionRequestSchema)).toMatchObject([{ meshId: "m" }]);
    progress("cut");
    newest().respond(CreateSessionResponseSchema, { update: { case: "session", value: { sessionId: "s" } } });
    newest().end();
    await pass(0);
    expect(session.value?.sessionId).toBe("s");
    expect(stages).toEqual(["read", "cut"]);
  });

  it("is given up after a minute of failures in a row, which progress interrupts", async () => {
    const client = makeClient();
    const session = follow(client.createSession({ meshId: "m" }));
    const failFor = async (seconds: number) => {
      const end = performance.now() + 1000 * seconds;
      while (performance.now() < end && session.error === null) {
        if (!newest().isClosed) newest().lose(1006);
        await pass(0.1);
      }
    };
    await failFor(40);
    await until(() => !newest().isClosed);
    newest().open();
    newest().respond(CreateSessionResponseSchema, { update: { case: "progress", value: { stage: "read" } } });
    await pass(0);
    await failFor(40);
    expect(session.error).toBeNull();
    await failFor(30);
    expect(session.error?.code).toBe("UNAVAILABLE");
    expect(FakeWebSocket.made.length).toBeLessThan(60);
  });

  it("is asked for once where the server refuses, and no more once its signal is aborted", async () => {
    const client = makeClient();
    const refused = follow(client.createSession({ meshId: "m" }));
    newest().open();
    newest().end(1, { code: 3, message: "broken file" });
    await pass(10);
    expect(refused.error).toMatchObject({ code: "INVALID_ARGUMENT", message: "broken file" });
    expect(newest().requests.length).toBe(1);
    const stop = new AbortController();
    const stopped = follow(client.createSession({ meshId: "m", signal: stop.signal }));
    newest().lose(1006);
    await pass(0.01);
    stop.abort();
    await pass(0);
    expect(stopped.error?.code).toBe("CANCELLED");
    await pass(10);
    expect(FakeWebSocket.made.length).toBe(1);
  });
});

describe("an upload whose connection is lost", () => {
  const isSent = () => newest().requests.at(-1)?.halfClose === true;
  const chunks = () =>
    newest()
      .sent(UploadMeshRequestSchema)
      .slice(1)
      .map(({ part }) => (part.value as Uint8Array).length);

  it("begins again over another socket, and asks again what the mesh refers to", async () => {
    const progress: number[] = [];
    const named = { name: "a.obj", data: file.data };
    const upload = follow(makeClient().upload(named, [], { onProgress: (sent) => progress.push(sent) }));
    await until(() => FakeWebSocket.made.length === 1);
    newest().open().bufferedAmount = 5 << 20;
    await until(() => newest().requests.length >= 2);
    newest().lose(1006);
    await until(() => FakeWebSocket.made.length === 2);
    newest().open();
    await until(isSent);
    expect(chunks()).toEqual([262_144, 262_144, 90_112]);
    newest().respond(UploadMeshResponseSchema, { meshId: "mesh" });
    newest().end();
    await until(() => newest().requests.some(({ method }) => method === "ListMeshReferences"));
    newest().lose(1001);
    await until(() => FakeWebSocket.made.length === 3);
    newest().open();
    newest().respond(ListMeshReferencesResponseSchema, { missing: ["a.mtl"] });
    expect(progress.at(-1)).toBe(614_400);
    newest().end();
    await until(() => upload.value !== null);
    expect(upload.value).toEqual({ meshId: "mesh", companions: {}, missing: ["a.mtl"] });
    expect(progress.at(-1)).toBe(614_400);
  });

  it("is given up where it is lost again and again", async () => {
    const large = { name: "a.off", data: new Blob([new Uint8Array(6 << 20)]) };
    const upload = follow(makeClient().upload(large));
    await until(() => FakeWebSocket.made.length === 1);
    let sent = 0;
    for (let second = 0; second < 1000; second += 20) {
      await until(() => !newest().isClosed || upload.error !== null);
      if (upload.error !== null) break;
      newest().open();
      await until(isSent);
      ++sent;
      await pass(20);
      newest().lose(1001, "gone");
    }
    expect(upload.error).toMatchObject({ code: "UNAVAILABLE", message: "gone" });
    expect(sent).toBeGreaterThanOrEqual(5);
    expect(sent).toBeLessThanOrEqual(9);
  });
});

describe("the sockets of a client", () => {
  const mesh = "0123456789abcdef0000000000000000",
    session = "0123456789abcdef1111111111111111";

  it("name the mesh that their calls are about", async () => {
    const client = makeClient();
    void follow(client.createSession({ meshId: mesh }));
    void follow(client.getSession(session));
    void follow(client.listSessions());
    client.view(session).look(points(5));
    await pass(0);
    expect(FakeWebSocket.made.map(({ url }) => url)).toEqual(["ws://host?key=0123456789abcdef"]);
    void follow(client.getSession("another"));
    await pass(0);
    expect(newest().url).toBe("ws://host?key=another");
    expect(server().isClosed).toBe(false);
    client.close();
    await pass(0);
    expect(FakeWebSocket.made.map(({ isClosed }) => isClosed)).toEqual([true, true]);
  });

  it("name the mesh that is uploaded, where its hash is to be had", async () => {
    const urls = async (data: Blob) => {
      FakeWebSocket.made = [];
      const client = makeClient();
      follow(client.upload({ name: "a.off", data }));
      await until(() => FakeWebSocket.made.length === 1);
      client.close();
      return FakeWebSocket.made.map(({ url }) => url);
    };
    const abc = new Blob(["abc"]);
    expect(await urls(abc)).toEqual(["ws://host?key=ba7816bf8f01cfea"]);
    expect(await urls({ size: 1e12 } as Blob)).toEqual(["ws://host"]);
    expect(await urls({ size: 3, arrayBuffer: () => Promise.reject(new Error("unreadable")) } as unknown as Blob)).toEqual([
      "ws://host",
    ]);
    vi.stubGlobal("crypto", {});
    expect(await urls(abc)).toEqual(["ws://host"]);
  });

  it("are closed when their calls are over and another is needed", async () => {
    const client = new Client({
      url: "ws://host/?a=b",
      webSocket: FakeWebSocket.make,
      decoder,
    });
    const list = follow(client.listSessions());
    server().open().respond(ListSessionsResponseSchema, {});
    server().end();
    await pass(0);
    expect(list.value).toEqual([]);
    void follow(client.getSession(session));
    await pass(0);
    expect(FakeWebSocket.made.map(({ url, isClosed }) => [url, isClosed])).toEqual([
      ["ws://host/?a=b", true],
      ["ws://host/?a=b&key=0123456789abcdef", false],
    ]);
    client.close();
  });
});
