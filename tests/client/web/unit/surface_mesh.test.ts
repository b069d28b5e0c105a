import { create, fromBinary, type MessageInitShape } from "@bufbuild/protobuf";
import { beforeAll, describe, expect, it } from "vitest";

import {
  GetSurfaceRequestSchema,
  GetSurfaceResponseSchema,
  type GetSurfaceResponse,
} from "../../../../client/web/src/gen/curvecast/v1/curvecast_pb";
import { Client } from "../../../../client/web/src/stream/client";
import type { Decoder } from "../../../../client/web/src/stream/decoder";
import { DracoLibrary } from "../../../../client/web/src/stream/draco/library";
import type { SurfaceMesh } from "../../../../client/web/src/stream/decoded_surface";
import { decodeSurface } from "../../../../client/web/src/stream/surface_decoder";
import { readSurface } from "../../../../client/web/src/stream/surface_mesh";
import { encodedCloud, encodedMesh, loadDecoder } from "./draco_modules";
import { FakeWebSocket, settle } from "./fake_web_socket";
import { cube } from "../support/plain_meshes";

type Message = MessageInitShape<typeof GetSurfaceResponseSchema>;

const library = new DracoLibrary(loadDecoder);
const decoder: Decoder = { decode: () => Promise.resolve([]), decodeSurface: (surface) => decodeSurface(surface, library) };
const colours = cube().positions.map((value) => (value > 0 ? 200 : 50));

let file: Uint8Array<ArrayBuffer>; // of a cube with colours
beforeAll(async () => (file = await encodedMesh({ ...cube(), colours })));

const usual = { vertices: 8n, triangles: 12n, origin: { x: 9, y: 0, z: 0 }, creaseDegrees: 40 };
const info = (change = {}, bytes = file.length): Message => ({
  update: { case: "info", value: { ...usual, bytes: BigInt(bytes), ...change } },
});
const part = (begin?: number, end?: number): Message => ({ update: { case: "chunk", value: file.slice(begin, end) } });

async function* sent(messages: readonly Message[], seen: Message[] = []): AsyncGenerator<GetSurfaceResponse> {
  for (const message of messages) {
    seen.push(message);
    yield Promise.resolve(create(GetSurfaceResponseSchema, message));
  }
}

const read = (...messages: Message[]): Promise<SurfaceMesh> => readSurface(sent(messages), decoder);

describe("a surface", () => {
  it("is joined from its parts, with normals of each side and colours of each vertex", async () => {
    const surface = await read(info(), part(0, 20), part(20, 21), part(21));
    expect(surface).toMatchObject({ origin: [9, 0, 0], bytes: file.length });
    expect(surface.triangles.length).toBe(36);
    expect(surface.positions.length).toBe(3 * 24);
    surface.positions.forEach((value, i) => {
      expect(Math.abs(value)).toBeCloseTo(1, 3);
      expect(surface.colours![i]).toBe(value > 0 ? 200 : 50);
    });
    for (const value of surface.normals) expect([0, 1]).toContain(Math.round(1e4 * Math.abs(value)) / 1e4);
  });

  it("may have no colours, and no creases", async () => {
    file = await encodedMesh(cube());
    const surface = await read(info({ creaseDegrees: 180 }), part());
    expect(surface.colours).toBeNull();
    expect(surface.normals.length).toBe(3 * 8);
    file = await encodedMesh({ ...cube(), colours });
  });

  it.each<[string, () => Message[]]>([
    ["nothing", () => []],
    ["a part without a beginning", () => [part()]],
    ["two beginnings", () => [info(), info(), part()]],
    ["cut off", () => [info(), part(0, file.length - 1)]],
    ["longer than announced", () => [info(), part(), part(0, 1)]],
    ["of more triangles than there can be", () => [info({ triangles: 1_000_001n }), part()]],
    ["of numbers that no memory holds", () => [info({ vertices: 2n ** 63n, triangles: 2n ** 63n }), part()]],
    ["of more vertices than its triangles have", () => [info({ vertices: 37n }), part()]],
    ["too large", () => [info({ bytes: (64n << 20n) + 1n }), part()]],
    ["of no triangles", () => [info({ triangles: 0n }), part()]],
    ["of another number of triangles", () => [info({ triangles: 11n }), part()]],
    ["of fewer vertices", () => [info({ vertices: 7n }), part()]],
    ["of more vertices", () => [info({ vertices: 9n }), part()]],
    ["nowhere", () => [info({ origin: { x: NaN, y: 0, z: 0 } }), part()]],
    ["without an origin", () => [info({ origin: undefined }), part()]],
    ["of impossible creases", () => [info({ creaseDegrees: 200 }), part()]],
  ])("is refused that is %s", async (_, messages) => {
    await expect(read(...messages())).rejects.toMatchObject({ name: "CurvecastError", code: "DATA_LOSS" });
  });

  it("is refused that is a cloud, a list of triangles, or no Draco data", async () => {
    const usualCloud = { points: 8, positionBits: 11, normalBits: 7, speed: 5, noise: 0.05, colours: true, others: false };
    const whole = file;
    for (file of [await encodedCloud(usualCloud), await encodedMesh(cube(), true), new Uint8Array(100)]) {
      await expect(read(info(), part())).rejects.toMatchObject({ code: "DATA_LOSS" });
    }
    file = whole;
  });

  it("breaks nothing, whichever byte of it is wrong", async () => {
    const whole = file;
    for (let i = 0; i < whole.length; ++i) {
      for (const flip of [1, 0x80, 0xff]) {
        file = whole.slice();
        file[i]! ^= flip;
        const surface = await read(info(), part()).catch((error: unknown) => {
          expect(error).toMatchObject({ code: "DATA_LOSS" });
          return null;
        });
        if (surface !== null) expect(surface.normals.every(Number.isFinite)).toBe(true);
      }
    }
    file = whole;
    expect((await read(info(), part())).triangles.length).toBe(36);
  });

  it("claims no more triangles than its bytes can hold", async () => {
    const whole = file;
    // After the header of 11 bytes and a byte of the method: numbers of vertices and triangles.
    file = Uint8Array.from([...whole.slice(0, 12), 0x8f, 0x92, 0x16, 0xc0, 0x84, 0x3d, ...whole.slice(14)]);
    const claim = { vertices: 362_767n, triangles: 1_000_000n };
    await expect(read(info(claim), part())).rejects.toMatchObject({ message: expect.stringContaining("claims") as string });
    file = whole;
  });

  it("is not read beyond the first fault", async () => {
    const seen: Message[] = [];
    const endless = [info(), ...Array.from({ length: 100 }, () => part())];
    await expect(readSurface(sent(endless, seen), decoder)).rejects.toMatchObject({ code: "DATA_LOSS" });
    expect(seen.length).toBe(3);
  });
});

describe("a client that asks for a surface", () => {
  const socket = () => FakeWebSocket.made.at(-1)!;
  const client = () => {
    FakeWebSocket.made = [];
    return new Client({ url: "ws://host", webSocket: FakeWebSocket.make, decoder });
  };
  const answer = () => {
    for (const message of [info(), part()]) socket().respond(GetSurfaceResponseSchema, message);
    socket().end();
  };

  it("says which, and has it, also after the connection was lost", async () => {
    const surface = client().surface("session");
    socket().open();
    expect(socket().requests[0]!.method).toBe("GetSurface");
    expect(fromBinary(GetSurfaceRequestSchema, socket().requests[0]!.message!)).toMatchObject({ sessionId: "session" });
    socket().respond(GetSurfaceResponseSchema, info());
    socket().lose(1006);
    while (FakeWebSocket.made.length < 2) await settle(1);
    socket().open();
    answer();
    expect((await surface).triangles.length).toBe(36);
  });

  it("leaves the socket of other calls alone", async () => {
    const one = client();
    one.listSessions().catch(() => {});
    const surface = one.surface("session");
    expect(FakeWebSocket.made.length).toBe(2);
    socket().open();
    answer();
    await surface;
    one.close();
  });

  it("tells the server when it wants it no more, and hears why there is none", async () => {
    const stop = new AbortController();
    const stopped = client().surface("session", { signal: stop.signal });
    socket().open().respond(GetSurfaceResponseSchema, info());
    await settle();
    stop.abort();
    await expect(stopped).rejects.toMatchObject({ code: "CANCELLED" });
    expect(socket().requests.at(-1)).toMatchObject({ call: 1, cancel: true });
    const refused = client().surface("session");
    socket().open().end(1, { code: 9, message: "the surface has textures" });
    await expect(refused).rejects.toMatchObject({ code: "FAILED_PRECONDITION", message: "the surface has textures" });
  });
});
