import { create } from "@bufbuild/protobuf";
import { describe, expect, it, vi } from "vitest";

import { PointBlockSchema } from "../../../../client/web/src/gen/curvecast/v1/curvecast_pb";
import { BlockDecoder, buffersOf, encodedBlock, type EncodedBlock } from "../../../../client/web/src/stream/block_decoder";
import type { DecodeRequest, DecodeResponse } from "../../../../client/web/src/stream/decode_worker";
import { WorkerDecoder } from "../../../../client/web/src/stream/decoder";
import { CurvecastError } from "../../../../client/web/src/stream/errors";
import { DracoLibrary } from "../../../../client/web/src/stream/draco/library";
import { dracoBlock } from "./draco_block";
import { encodedCloud, loadDecoder } from "./draco_modules";

const decoder = new BlockDecoder(new DracoLibrary(loadDecoder));

function block(data = dracoBlock.data, count = dracoBlock.count): EncodedBlock {
  const { radius } = dracoBlock;
  return encodedBlock(
    create(PointBlockSchema, {
      count,
      origin: { x: 1, y: 2, z: 3 },
      data: { case: "draco", value: { data, radiusMin: radius, radiusMax: radius } },
    }),
  );
}

function rawBlock(count: number, change: (floats: Float32Array) => void = () => {}): EncodedBlock {
  const positions = Float32Array.from({ length: 3 * count }, (_, i) => i / 8);
  change(positions);
  const bytes = (array: Float32Array) => new Uint8Array(array.buffer);
  return encodedBlock(
    create(PointBlockSchema, {
      count,
      data: {
        case: "raw",
        value: {
          positions: bytes(positions),
          normals: bytes(Float32Array.from({ length: 3 * count }, (_, i) => (i % 3 === 2 ? -1 : 0))),
          radii: bytes(new Float32Array(count).fill(0.25)),
          colours: new Uint8Array(3 * count).fill(7),
        },
      },
    }),
  );
}

describe("Draco blocks", () => {
  it("hold positions, normals and radii", async () => {
    const points = await decoder.decode(block());
    expect(points.count).toBe(48);
    expect(points.origin).toEqual([1, 2, 3]);
    expect(points.colours).toBeNull();
    for (const [index, expected] of [
      [0, dracoBlock.first],
      [47, dracoBlock.last],
    ] as const) {
      const slot = 4 * index;
      for (let axis = 0; axis < 3; ++axis) {
        expect(points.positions[slot + axis]).toBeCloseTo(expected[axis]!, 2);
        expect(Math.abs(points.normals[slot + axis]! / 127 - expected[3 + axis]!)).toBeLessThan(0.03);
      }
      expect(points.positions[slot + 3]).toBeCloseTo(dracoBlock.radius, 6);
    }
    expect(buffersOf(points).length).toBe(2);
  });

  it("are refused where their bytes are cut off, and the decoder goes on", async () => {
    for (let length = 0; length < dracoBlock.data.length - 1; length += 7) {
      await expect(decoder.decode(block(dracoBlock.data.slice(0, length)))).rejects.toThrow(/bad points/);
    }
    expect((await decoder.decode(block())).count).toBe(48);
  });

  it("never give anything but finite points when bits are flipped", async () => {
    for (let bit = 0; bit < 8 * dracoBlock.data.length; bit += 5) {
      const data = dracoBlock.data.slice();
      data[bit >> 3]! ^= 1 << (bit & 7);
      try {
        const points = await decoder.decode(block(data));
        expect(points.positions.every(Number.isFinite)).toBe(true);
      } catch (thrown) {
        expect(String(thrown)).toMatch(/bad points/);
      }
    }
    expect((await decoder.decode(block())).count).toBe(48);
  });

  it("may claim neither another number of points than the block nor an absurd one", async () => {
    await expect(decoder.decode(block(dracoBlock.data, 47))).rejects.toThrow(/48 points in a block of 47/);
    const absurd = dracoBlock.data.slice();
    new DataView(absurd.buffer).setInt32(11, 2_000_000_000, true);
    await expect(decoder.decode(block(absurd, 2_000_000_000))).rejects.toThrow(/claims 2000000000 points/);
  });
});

describe("Draco blocks of another kind", () => {
  it("are decoded by Draco's own decoder, which is loaded anew where it could not be", async () => {
    const data = await encodedCloud({
      points: 500,
      positionBits: 11,
      normalBits: 7,
      speed: 5,
      noise: 0.1,
      colours: true,
      others: true,
    });
    let loads = 0;
    const late = new BlockDecoder(
      new DracoLibrary(() => (++loads === 1 ? Promise.reject(new CurvecastError("UNAVAILABLE", "gone")) : loadDecoder())),
    );
    await expect(late.decode(block(data, 500))).rejects.toThrow(/gone/);
    const [points, again] = await Promise.all([late.decode(block(data, 500)), late.decode(block(data, 500))]);
    expect(loads).toBe(2);
    expect(points).toEqual(again);
    expect(points.colours!.length).toBe(2000);
    expect(Math.hypot(...[0, 1, 2].map((axis) => points.positions[axis]! + 3))).toBeCloseTo(10, 1);
    expect(points.positions[3]).toBeCloseTo(dracoBlock.radius, 6);
  });

  it("go to a worker thread however few their points are, as no other thread has that decoder", async () => {
    const sent: DecodeRequest[] = [];
    vi.stubGlobal(
      "Worker",
      class {
        onmessage: ((event: { data: DecodeResponse }) => void) | null = null;
        postMessage(request: DecodeRequest) {
          sent.push(request);
          if (!("block" in request)) return;
          void decoder.decode(request.block).then((points) => this.onmessage?.({ data: { job: request.job, points } }));
        }
        terminate() {}
      },
    );
    const { radius } = dracoBlock;
    const plain = { points: 500, positionBits: 11, normalBits: 7, speed: 5, noise: 0.1, colours: true };
    const threads = new WorkerDecoder();
    for (const others of [false, true]) {
      const data = await encodedCloud({ ...plain, others });
      const message = create(PointBlockSchema, {
        count: 500,
        data: { case: "draco", value: { data, radiusMin: radius, radiusMax: radius } },
      });
      const [points] = await threads.decode([message]);
      expect(points).toEqual(await decoder.decode(encodedBlock(message)));
      expect(sent.length).toBe(others ? 1 : 0);
    }
    threads.close();
    vi.unstubAllGlobals();
  });
});

describe("raw blocks", () => {
  it("are taken as they are", async () => {
    const points = await decoder.decode(rawBlock(5));
    expect([...points.positions.subarray(16, 20)]).toEqual([12 / 8, 13 / 8, 14 / 8, 0.25]);
    expect([...points.normals.subarray(0, 4)]).toEqual([0, 0, -127, 0]);
    expect([...points.colours!.subarray(0, 4)]).toEqual([7, 7, 7, 255]);
  });

  it("have directions, and scalars of which some may not be numbers", async () => {
    const bytes = (...values: number[]) => new Uint8Array(Float32Array.from(values).buffer);
    const directions = bytes(1, 0, 0, 0, 1, 0);
    const scalars = [{ name: "heat", values: bytes(5, NaN) }];
    const block = { ...rawBlock(2), directions, scalars };
    const points = await decoder.decode(block);
    expect([...points.directions!]).toEqual([1, 0, 0, 0, 1, 0]);
    expect(points.scalars.map(({ name, values }) => [name, ...values])).toEqual([["heat", 5, NaN]]);
    expect(buffersOf(points)).toContain(points.scalars[0]!.values.buffer);
    expect(buffersOf(block)).toContain(scalars[0]!.values.buffer);
    await expect(decoder.decode({ ...block, directions: bytes(1, 0, 0, 0, NaN, 0) })).rejects.toThrow(
      /directions that are not finite/,
    );
    await expect(decoder.decode({ ...block, scalars: [{ name: "heat", values: bytes(5) }] })).rejects.toThrow(/scalar heat/);
    await expect(decoder.decode({ ...block, scalars: [...scalars, ...scalars] })).rejects.toThrow(/two scalars/);
  });

  it("are refused where values are not finite or bytes are lacking", async () => {
    await expect(decoder.decode(rawBlock(5, (floats) => (floats[7] = NaN)))).rejects.toThrow(/not finite/);
    await expect(decoder.decode(rawBlock(5, (floats) => (floats[0] = -Infinity)))).rejects.toThrow(/not finite/);
    await expect(decoder.decode({ ...rawBlock(5), count: 6 })).rejects.toThrow(/bytes of radii where 24 belong/);
    await expect(decoder.decode({ ...rawBlock(5), ranks: new Uint8Array(19) })).rejects.toThrow(/19 bytes of ranks/);
    await expect(decoder.decode({ ...rawBlock(5), raw: null })).rejects.toThrow(/neither/);
  });
});
