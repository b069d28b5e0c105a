import { create, fromBinary, type MessageInitShape, type MessageShape } from "@bufbuild/protobuf";
import { describe, expect, it } from "vitest";

import {
  RemeshRequestSchema,
  RemeshResponseSchema,
  type PointBlockSchema,
  type RemeshResponse,
} from "../../../../client/web/src/gen/curvecast/v1/curvecast_pb";
import { BlockDecoder, encodedBlock } from "../../../../client/web/src/stream/block_decoder";
import { Client } from "../../../../client/web/src/stream/client";
import type { Decoder } from "../../../../client/web/src/stream/decoder";
import { decodeSurface } from "../../../../client/web/src/stream/surface_decoder";
import { readMesh, type TriangleMesh } from "../../../../client/web/src/stream/triangle_mesh";
import { FakeWebSocket, settle } from "./fake_web_socket";

type Message = MessageInitShape<typeof RemeshResponseSchema>;
type Block = Exclude<MessageInitShape<typeof PointBlockSchema>, MessageShape<typeof PointBlockSchema>>;

const blocks = new BlockDecoder(null);
const decoder: Decoder = {
  decode: (all) => Promise.all(all.map((block) => blocks.decode(encodedBlock(block)))),
  decodeSurface,
};

const places = [
  [1, 0, 0],
  [-1, 0, 0],
  [0, 1, 0],
  [0, -1, 0],
  [0, 0, 1],
  [0, 0, -1],
];
const faces = [
  [0, 2, 4],
  [2, 1, 4],
  [1, 3, 4],
  [3, 0, 4],
  [2, 0, 5],
  [1, 2, 5],
  [3, 1, 5],
  [0, 3, 5],
];

const bytesOf = (values: Float32Array | Uint32Array) => new Uint8Array(values.buffer);
const progress: Message = { update: { case: "progress", value: { stage: "triangulate", fraction: 0.5 } } };
const info = (vertices = 6n, triangles = 8n): Message => ({ update: { case: "info", value: { vertices, triangles } } });
const withFaces = (...which: number[][]): Message => ({
  update: { case: "chunk", value: { triangles: bytesOf(Uint32Array.from(which.flat())) } },
});

/// The octahedron's vertices from `begin` to `end`.
function withVertices(begin: number, end: number, change: Block = {}): Message {
  const some = Float32Array.from(places.slice(begin, end).flat());
  const raw = { positions: bytesOf(some), normals: bytesOf(some), radii: bytesOf(new Float32Array(end - begin).fill(1)) };
  const vertices: Block = { count: end - begin, origin: { x: 9, y: 0, z: 0 }, data: { case: "raw", value: raw }, ...change };
  return { update: { case: "chunk", value: { vertices } } };
}

async function* sent(messages: readonly Message[], seen: RemeshResponse[] = []): AsyncGenerator<RemeshResponse> {
  for (const message of messages) {
    const response = create(RemeshResponseSchema, message);
    seen.push(response);
    yield Promise.resolve(response);
  }
}

const read = (...messages: Message[]): Promise<TriangleMesh> => readMesh(sent(messages), decoder);
const octahedron = [
  progress,
  info(),
  withVertices(0, 4),
  withVertices(4, 6),
  withFaces(...faces.slice(0, 3)),
  withFaces(...faces.slice(3)),
];

describe("a mesh", () => {
  it("is joined from its parts, however these are cut", async () => {
    const stages: string[] = [];
    const cut = await readMesh(sent(octahedron), decoder, ({ stage }) => stages.push(stage));
    const whole = await read(info(), withVertices(0, 6), withFaces(...faces));
    expect(stages).toEqual(["triangulate"]);
    for (const { vertices, triangles } of [cut, whole]) {
      expect([...triangles]).toEqual(faces.flat());
      expect(vertices.count).toBe(6);
      expect(vertices.origin).toEqual([9, 0, 0]);
      places.forEach((place, i) => {
        expect([...vertices.positions.subarray(4 * i, 4 * i + 4)]).toEqual([...place, 1]);
        expect([...vertices.normals.subarray(4 * i, 4 * i + 3)]).toEqual(place.map((value) => 127 * value));
      });
    }
  });

  const all = withFaces(...faces);
  const vertices = withVertices(0, 6);
  const cutFace: Message = { update: { case: "chunk", value: { triangles: new Uint8Array(8 * 12 - 1) } } };
  it.each<[string, Message[]]>([
    ["nothing", []],
    ["progress alone", [progress]],
    ["parts without a beginning", [vertices, all]],
    ["a beginning after the first part", [vertices, info(), all]],
    ["two beginnings", [info(), info(), vertices, all]],
    ["too few vertices", [info(), withVertices(0, 5), withFaces(...faces.slice(0, 1))]],
    ["too many vertices", [info(), vertices, withVertices(0, 1), all]],
    ["too few triangles", [info(), vertices, withFaces(...faces.slice(1))]],
    ["too many triangles", [info(), vertices, all, withFaces([0, 2, 4])]],
    ["a part of a triangle", [info(), vertices, cutFace]],
    ["a vertex that is not there", [info(), vertices, withFaces(...faces.slice(1), [0, 2, 6])]],
    ["a vertex far from there", [info(), vertices, withFaces(...faces.slice(1), [0, 2, 0xffffffff])]],
    ["a triangle without area", [info(), vertices, withFaces(...faces.slice(1), [3, 3, 4])]],
    ["a triangle without area, closed", [info(), vertices, withFaces(...faces.slice(1), [3, 4, 3])]],
    ["triangles without vertices", [info(0n, 8n), all]],
    ["more vertices than there can be", [info(4_000_001n, 8n)]],
    ["more triangles than there can be", [info(6n, 16_000_001n)]],
    ["numbers that no memory holds", [info(2n ** 63n, 2n ** 63n)]],
    ["a block that counts wrong", [info(), withVertices(0, 6, { count: 5 }), withVertices(0, 1), all]],
    ["a block without data", [info(), withVertices(0, 6, { data: { case: undefined } }), all]],
    ["parts of different origins", [info(), withVertices(0, 4), withVertices(4, 6, { origin: { x: 8, y: 0, z: 0 } }), all]],
    ["an origin nowhere", [info(), withVertices(0, 6, { origin: { x: NaN, y: 0, z: 0 } }), all]],
  ])("is refused that is %s", async (_, messages) => {
    await expect(read(...messages)).rejects.toMatchObject({ name: "CurvecastError", code: "DATA_LOSS" });
  });

  it("is refused where a position is not finite", async () => {
    const bad = withVertices(0, 6);
    const chunk = bad.update?.case === "chunk" ? bad.update.value : {};
    const raw = chunk.vertices?.data?.case === "raw" ? chunk.vertices.data.value : {};
    new Float32Array(raw.positions!.buffer)[7] = Infinity;
    await expect(read(info(), bad, withFaces(...faces))).rejects.toMatchObject({ code: "DATA_LOSS" });
  });

  it("is not read beyond the first fault", async () => {
    const seen: RemeshResponse[] = [];
    const endless = [info(), ...Array.from({ length: 100 }, () => withVertices(0, 6))];
    await expect(readMesh(sent(endless, seen), decoder)).rejects.toMatchObject({ code: "DATA_LOSS" });
    expect(seen.length).toBe(3);
  });
});

describe("a client that asks for a mesh", () => {
  const socket = () => FakeWebSocket.made.at(-1)!;
  const client = () => {
    FakeWebSocket.made = [];
    return new Client({ url: "ws://host", webSocket: FakeWebSocket.make, decoder });
  };
  const sample = { budget: { case: "points" as const, value: 6n } };

  it("says what it wants, and has it", async () => {
    const mesh = client().remesh("session", sample, { relaxations: 0 });
    socket().open();
    expect(socket().requests[0]!.method).toBe("Remesh");
    const request = fromBinary(RemeshRequestSchema, socket().requests[0]!.message!);
    expect(request).toMatchObject({ sessionId: "session", relaxations: 0, sample: { budget: { case: "points", value: 6n } } });
    for (const message of octahedron) socket().respond(RemeshResponseSchema, message);
    socket().end();
    expect((await mesh).triangles.length).toBe(24);
  });

  it("tells the server when it wants it no more, and when it cannot use it", async () => {
    const stop = new AbortController();
    const stopped = client().remesh("session", sample, { signal: stop.signal });
    socket().open();
    socket().respond(RemeshResponseSchema, progress);
    await settle();
    stop.abort();
    await expect(stopped).rejects.toMatchObject({ code: "CANCELLED" });
    expect(socket().requests.at(-1)).toMatchObject({ call: 1, cancel: true });

    const bad = client().remesh("session", sample);
    socket().open();
    for (const message of [info(), withFaces([0, 0, 0])]) socket().respond(RemeshResponseSchema, message);
    for (let i = 0; i < 8; ++i) socket().respond(RemeshResponseSchema, withFaces([0, 1, 2]));
    await expect(bad).rejects.toMatchObject({ code: "DATA_LOSS" });
    expect(socket().requests.at(-1)).toMatchObject({ call: 1, cancel: true });
  });

  it("leaves the socket of other calls alone", async () => {
    const one = client();
    one.listSessions().catch(() => {});
    const mesh = one.remesh("session", sample);
    expect(FakeWebSocket.made.length).toBe(2);
    socket().open();
    for (const message of octahedron) socket().respond(RemeshResponseSchema, message);
    socket().end();
    await mesh;
    one.close();
    expect(FakeWebSocket.made.map(({ isClosed }) => isClosed)).toEqual([true, true]);
  });

  it("asks again where the connection was lost", async () => {
    const mesh = client().remesh("session", sample);
    socket().open();
    socket().respond(RemeshResponseSchema, info());
    socket().lose(1006);
    while (FakeWebSocket.made.length < 2) await settle(1);
    socket().open();
    for (const message of octahedron) socket().respond(RemeshResponseSchema, message);
    socket().end();
    expect((await mesh).vertices.count).toBe(6);
  });
});
