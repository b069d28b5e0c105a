import { create, toBinary } from "@bufbuild/protobuf";
import { beforeEach, describe, expect, it } from "vitest";

import {
  CreateSessionRequestSchema,
  CreateSessionResponseSchema,
  CurvecastService,
  GetSessionRequestSchema,
  GetSessionResponseSchema,
  ListMeshReferencesResponseSchema,
  UploadMeshRequestSchema,
  UploadMeshResponseSchema,
} from "../../../../client/web/src/gen/curvecast/v1/curvecast_pb";
import { RetryInfoSchema } from "../../../../client/web/src/gen/curvecast/v1/status_pb";
import { CurvecastError } from "../../../../client/web/src/stream/errors";
import { meshAmong, uploadFile, uploadMesh } from "../../../../client/web/src/stream/mesh_upload";
import { Socket } from "../../../../client/web/src/stream/socket";
import { FakeWebSocket, settle, until } from "./fake_web_socket";

const { getSession, createSession } = CurvecastService.method;

function connect(token?: string): [Socket, FakeWebSocket] {
  const socket = new Socket({ url: "ws://host/v1/socket", token, webSocket: FakeWebSocket.make });
  return [socket, FakeWebSocket.made.at(-1)!];
}

async function failure(promise: Promise<unknown>): Promise<CurvecastError> {
  const thrown: unknown = await promise.then(
    () => null,
    (error: unknown) => error,
  );
  expect(thrown).toBeInstanceOf(CurvecastError);
  return thrown as CurvecastError;
}

beforeEach(() => (FakeWebSocket.made = []));

describe("a socket", () => {
  it("names its protocol, and the token in base64url", () => {
    connect();
    connect("a?~ü>");
    expect(FakeWebSocket.made.map((made) => made.protocols)).toEqual([
      ["curvecast.v1"],
      ["curvecast.v1", `curvecast.bearer.${Buffer.from("a?~ü>").toString("base64url")}`],
    ]);
  });

  it("sends what is asked before it is open, and shares calls", async () => {
    const [socket, server] = connect();
    const first = socket.unary(getSession, { sessionId: "a" });
    const second = socket.unary(getSession, { sessionId: "b" });
    expect(server.requests).toEqual([]);
    server.open();
    expect(server.requests.map(({ call, method, halfClose }) => [call, method, halfClose])).toEqual([
      [1, "GetSession", true],
      [2, "GetSession", true],
    ]);
    expect(server.sent(GetSessionRequestSchema, 2)[0]!.sessionId).toBe("b");
    server.respond(GetSessionResponseSchema, { session: { meshId: "of b" } }, 2);
    server.end(2);
    server.respond(GetSessionResponseSchema, { session: { meshId: "of a" } }, 1);
    server.end(1);
    expect((await first).session!.meshId).toBe("of a");
    expect((await second).session!.meshId).toBe("of b");
  });

  it("gives errors their code, message and time to wait", async () => {
    const [socket, server] = connect();
    server.open();
    const call = socket.unary(getSession, { sessionId: "a" });
    const value = toBinary(RetryInfoSchema, create(RetryInfoSchema, { retryDelay: { seconds: 2n, nanos: 500_000_000 } }));
    server.end(1, { code: 8, message: "no room", details: [{ typeUrl: "type.googleapis.com/google.rpc.RetryInfo", value }] });
    expect(await failure(call)).toMatchObject({ code: "RESOURCE_EXHAUSTED", message: "no room", retryAfter: 2.5 });
  });

  it("iterates over responses, and cancels when the loop is left", async () => {
    const [socket, server] = connect();
    server.open();
    const stages: string[] = [];
    const loop = (async () => {
      for await (const { update } of socket.serverStream(createSession, { meshId: "m" })) {
        if (update.case === "progress") stages.push(update.value.stage);
        if (stages.length === 3) break;
      }
    })();
    expect(server.sent(CreateSessionRequestSchema)).toMatchObject([{ meshId: "m" }]);
    await settle();
    for (const stage of ["read", "cut", "map"])
      server.respond(CreateSessionResponseSchema, { update: { case: "progress", value: { stage } } });
    await loop;
    expect(stages).toEqual(["read", "cut", "map"]);
    expect(server.requests.at(-1)).toMatchObject({ call: 1, cancel: true, method: "" });
  });

  it("tells an iteration of an error after the last response", async () => {
    const [socket, server] = connect();
    server.open();
    const seen: unknown[] = [];
    const loop = (async () => {
      for await (const { update } of socket.serverStream(createSession, { meshId: "m" })) seen.push(update.case);
    })();
    await settle();
    server.respond(CreateSessionResponseSchema, { update: { case: "progress", value: { stage: "read" } } });
    server.end(1, { code: 3, message: "broken file" });
    expect(await failure(loop)).toMatchObject({ code: "INVALID_ARGUMENT", message: "broken file" });
    expect(seen).toEqual(["progress"]);
  });

  it("cancels by a signal, and forgets what the server still says", async () => {
    const [socket, server] = connect();
    server.open();
    const stop = new AbortController();
    const call = socket.unary(getSession, { sessionId: "a" }, stop.signal);
    stop.abort();
    expect((await failure(call)).code).toBe("CANCELLED");
    expect(server.requests.at(-1)!.cancel).toBe(true);
    server.end(1, { code: 1, message: "cancelled" });
    expect((await failure(socket.unary(getSession, {}, stop.signal))).code).toBe("CANCELLED");
  });

  it.each([
    [1006, "", "UNAVAILABLE"],
    [1001, "shutting down", "UNAVAILABLE"],
    [1008, "unknown token", "UNAUTHENTICATED"],
    [1008, "this origin is not allowed", "UNAUTHENTICATED"],
    [1007, "", "INTERNAL"],
    [1009, "", "INVALID_ARGUMENT"],
  ])("that closes with %i %s ends its calls, and those to come, as it says", async (code, reason, name) => {
    const [socket, server] = connect();
    server.open();
    const call = socket.unary(getSession, { sessionId: "a" });
    server.lose(code, reason);
    const error = await failure(call);
    expect(error.code).toBe(name);
    if (reason !== "") expect(error.message).toBe(reason);
    expect(socket.error).toBe(error);
    expect((await failure(socket.unary(getSession, {}))).code).toBe(name);
  });

  it("stops an iteration by a signal, before it begins or while it waits", async () => {
    const [socket, server] = connect();
    server.open();
    const stop = new AbortController();
    const loop = (async () => {
      for await (const _ of socket.serverStream(createSession, { meshId: "m" }, stop.signal));
    })();
    await settle();
    stop.abort(new Error("of another kind"));
    expect((await failure(loop)).code).toBe("CANCELLED");
    expect(server.requests.at(-1)).toMatchObject({ call: 1, cancel: true });
    expect((await failure(socket.serverStream(createSession, {}, stop.signal).next())).code).toBe("CANCELLED");
    expect(server.requests.length).toBe(2);
  });

  it("closes on bytes that are no message, and ends a call with a broken one", async () => {
    const [socket, server] = connect();
    server.open();
    const broken = socket.unary(getSession, { sessionId: "a" });
    server.respond(UploadMeshResponseSchema, { meshId: "a string where a session belongs" });
    expect((await failure(broken)).code).toBe("DATA_LOSS");
    const call = socket.unary(getSession, { sessionId: "a" });
    server.onmessage!({ data: new Uint8Array([0x0f, 0xff, 0xff]).buffer });
    expect((await failure(call)).code).toBe("DATA_LOSS");
    expect(server.isClosed).toBe(true);
  });
});

describe("an upload", () => {
  const file = { name: "a.off", data: new Blob([new Uint8Array(600 << 10).fill(7)]) };

  it("sends a header and chunks of 256 KiB, and tells how far it is", async () => {
    const [socket, server] = connect();
    server.open();
    const progress: number[] = [];
    const upload = uploadFile(() => socket, file, { onProgress: (sent) => progress.push(sent) });
    await until(() => server.requests.at(-1)?.halfClose === true);
    const parts = server
      .sent(UploadMeshRequestSchema)
      .map(({ part }) => (part.case === "header" ? [part.value.name, part.value.size] : part.value?.length));
    expect(parts).toEqual([["a.off", 614_400n], 262_144, 262_144, 90_112]);
    server.respond(UploadMeshResponseSchema, { meshId: "id" });
    server.end();
    expect(await upload).toBe("id");
    expect(progress.at(-1)).toBe(614_400);
  });

  it("waits while the browser holds much back, and stops when it is cancelled", async () => {
    const [socket, server] = connect();
    server.open();
    server.bufferedAmount = 5 << 20;
    const stop = new AbortController();
    const upload = uploadFile(() => socket, file, { signal: stop.signal });
    await until(() => server.requests.length === 2);
    await settle(50);
    expect(server.sent(UploadMeshRequestSchema).length).toBe(2);
    stop.abort(new Error("of another kind"));
    expect((await failure(upload)).code).toBe("CANCELLED");
    expect(server.requests.at(-1)!.cancel).toBe(true);
  });

  it("ends at once when the server refuses it", async () => {
    const [socket, server] = connect();
    server.open();
    const upload = uploadFile(() => socket, file);
    server.end(1, { code: 8, message: "larger than the limit" });
    expect(await failure(upload)).toMatchObject({ code: "RESOURCE_EXHAUSTED", message: "larger than the limit" });
  });

  it("sends what a mesh refers to and was given, until nothing new is named", async () => {
    const [socket, server] = connect();
    server.open();
    const small = (name: string) => ({ name, data: new Blob([name]) });
    const upload = uploadMesh(() => socket, small("cow.obj"), [
      small("cow.obj"),
      small("Cow.mtl"),
      small("skin.png"),
      small("secret.txt"),
    ]);
    const answers: [number, () => void][] = [
      [1, () => server.respond(UploadMeshResponseSchema, { meshId: "mesh" }, 1)],
      [2, () => server.respond(ListMeshReferencesResponseSchema, { missing: ["cow.mtl", "secret.txt"] }, 2)],
      [3, () => server.respond(UploadMeshResponseSchema, { meshId: "library" }, 3)],
      [4, () => server.respond(ListMeshReferencesResponseSchema, { missing: ["secret.txt", "textures/skin.png", "gone.png"] }, 4)],
      [5, () => server.respond(UploadMeshResponseSchema, { meshId: "picture" }, 5)],
      [6, () => server.respond(ListMeshReferencesResponseSchema, { missing: ["secret.txt", "gone.png"] }, 6)],
    ];
    for (const [call, answer] of answers) {
      await until(() => server.requests.some((request) => request.call === call && request.halfClose));
      answer();
      server.end(call);
    }
    expect(await upload).toEqual({
      meshId: "mesh",
      companions: { "cow.mtl": "library", "textures/skin.png": "picture" },
      missing: ["secret.txt", "gone.png"],
    });
  });

  it("knows the mesh among several files", () => {
    const files = ["skin.png", "cow.mtl", "cow.obj"].map((name) => ({ name, data: new Blob([]) }));
    expect(meshAmong(files)?.name).toBe("cow.obj");
    expect(meshAmong(files.slice(0, 2))).toBeNull();
  });
});
