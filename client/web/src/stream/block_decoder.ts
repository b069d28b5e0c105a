// SPDX-License-Identifier: Apache-2.0
// Decodes blocks of points, Draco or raw, into the columns of a PointStore. Runs in a worker, and needs nothing of a browser.

import type { PointAttributes, PointBlock, RawPoints } from "../gen/curvecast/v1/curvecast_pb";
import { asFloats, writeColours, writeNormals, writePositions } from "./columns";
import { badPoints, type DecodedPoints } from "./decoded_points";
import { readHeader } from "./draco/header";
import type { DracoLibrary } from "./draco/library";
import { DracoReader } from "./draco/reader";
import type { EncodedSurface, SurfaceMesh } from "./decoded_surface";

/// A block in the form that goes to a worker: plain values, with copies of the message's bytes.
export interface EncodedBlock {
  count: number;
  origin: [number, number, number];
  draco: { data: Uint8Array<ArrayBuffer>; radiusMin: number; radiusMax: number } | null;
  raw: { positions: Uint8Array; normals: Uint8Array; radii: Uint8Array; colours: Uint8Array } | null;
  curvatures: Uint8Array;
  ranks: Uint8Array;
  directions: Uint8Array;
  scalars: { name: string; values: Uint8Array }[];
}

/// Copies a block of a message. Throws DATA_LOSS where the origin is not finite.
export function encodedBlock(block: PointBlock): EncodedBlock {
  const origin: [number, number, number] = [block.origin?.x ?? 0, block.origin?.y ?? 0, block.origin?.z ?? 0];
  if (!origin.every(Number.isFinite)) throw badPoints("an origin that is not finite");
  const { data } = block;
  const more: Partial<PointAttributes> = block.attributes ?? {};
  const empty = new Uint8Array(0);
  return {
    count: block.count,
    origin,
    draco:
      data.case === "draco"
        ? { data: data.value.data.slice(), radiusMin: data.value.radiusMin, radiusMax: data.value.radiusMax }
        : null,
    raw: data.case === "raw" ? copyRaw(data.value) : null,
    curvatures: more.curvatures?.slice() ?? empty,
    ranks: more.ranks?.slice() ?? empty,
    directions: more.directions?.slice() ?? empty,
    scalars: more.scalars?.map(({ name, values }) => ({ name, values: values.slice() })) ?? [],
  };
}

/// Lists the buffers of a block or of its points, of a surface or of its file, for their transfer to another thread.
export function buffersOf(holder: EncodedBlock | DecodedPoints | EncodedSurface | SurfaceMesh): ArrayBuffer[] {
  const viewsOf = (value: unknown): ArrayBufferView[] =>
    ArrayBuffer.isView(value) ? [value] : value !== null && typeof value === "object" ? Object.values(value).flatMap(viewsOf) : [];
  return [...new Set(viewsOf(holder).map((array) => array.buffer))].filter((buffer) => buffer instanceof ArrayBuffer);
}

/// Thrown for data that our reader does not read, where there is no library.
export class NeedsLibrary extends Error {}

/// Decodes blocks, one after the other. Rejects bad data with DATA_LOSS, and stays usable.
export class BlockDecoder {
  private readonly reader = new DracoReader();
  private readonly radii = new RadiusTable();

  /// `library`: decodes what our reader does not. Without one such blocks are rejected with NeedsLibrary.
  constructor(private readonly library: Pick<DracoLibrary, "read"> | null) {}

  async decode(block: EncodedBlock): Promise<DecodedPoints> {
    const points: DecodedPoints = {
      count: block.count,
      origin: block.origin,
      positions: new Float32Array(0),
      normals: new Int8Array(0),
      colours: null,
      curvatures: floatColumn(block.curvatures, 2 * block.count, "curvatures"),
      ranks: rankColumn(block.ranks, block.count),
      directions: floatColumn(block.directions, 3 * block.count, "directions"),
      scalars: block.scalars.map(({ name, values }) => ({ name, values: scalarColumn(values, block.count, name) })),
    };
    if (new Set(points.scalars.map(({ name }) => name)).size !== points.scalars.length) throw badPoints("two scalars of one name");
    if (block.draco !== null) await this.decodeDraco(block.draco, points);
    else if (block.raw !== null) decodeRaw(block.raw, points);
    else throw badPoints("a block that is neither Draco nor raw");
    return points;
  }

  private async decodeDraco(
    { data, radiusMin, radiusMax }: NonNullable<EncodedBlock["draco"]>,
    points: DecodedPoints,
  ): Promise<void> {
    const header = readHeader(data);
    if (header.points !== points.count) throw badPoints(`Draco data of ${header.points} points in a block of ${points.count}`);
    const radii = this.radii.of(radiusMin, radiusMax);
    makeColumns(points, header.hasColours);
    if (this.reader.read(data, header, radii, points)) return;
    if (this.library === null) throw new NeedsLibrary();
    await this.library.read(data, radii, points);
  }
}

/// Keeps the radius of every code between two radii: min (max / min)^(code / 255).
class RadiusTable {
  private radii = new Float32Array(256);
  private min = 0;
  private max = 0;

  of(min: number, max: number): Float32Array {
    if (!(min > 0 && min <= max && Number.isFinite(max))) throw badPoints(`radii from ${min} to ${max}`);
    if (min !== this.min || max !== this.max) {
      this.radii = Float32Array.from({ length: 256 }, (_, code) => min * (max / min) ** (code / 255));
      this.min = min;
      this.max = max;
    }
    return this.radii;
  }
}

function makeColumns(points: DecodedPoints, hasColours: boolean): void {
  points.positions = new Float32Array(4 * points.count);
  points.normals = new Int8Array(4 * points.count);
  if (hasColours) points.colours = new Uint8Array(4 * points.count);
}

function copyRaw(raw: RawPoints): EncodedBlock["raw"] {
  return {
    positions: raw.positions.slice(),
    normals: raw.normals.slice(),
    radii: raw.radii.slice(),
    colours: raw.colours.slice(),
  };
}

function decodeRaw(raw: NonNullable<EncodedBlock["raw"]>, points: DecodedPoints): void {
  const radii = checked(raw.radii, 4 * points.count, "radii");
  const positions = checked(raw.positions, 12 * points.count, "positions");
  const normals = checked(raw.normals, 12 * points.count, "normals");
  makeColumns(points, raw.colours.length > 0);
  writePositions(asFloats(positions), points);
  writeNormals(asFloats(normals), points);
  asFloats(radii).forEach((radius, i) => {
    if (!(radius >= 0 && radius < Infinity)) throw badPoints(`radius ${radius}`);
    points.positions[4 * i + 3] = radius;
  });
  if (points.colours !== null) writeColours(checked(raw.colours, 3 * points.count, "colours"), points.colours);
}

function checked(bytes: Uint8Array, expected: number, what: string): Uint8Array {
  if (bytes.length !== expected) throw badPoints(`${bytes.length} bytes of ${what} where ${expected} belong`);
  return bytes;
}

function floatColumn(bytes: Uint8Array, length: number, what: string): Float32Array<ArrayBuffer> | null {
  if (bytes.length === 0) return null;
  const values = asFloats(checked(bytes, 4 * length, what)).slice();
  if (!values.every(Number.isFinite)) throw badPoints(`${what} that are not finite`);
  return values;
}

/// Those of a mesh need not be finite.
function scalarColumn(bytes: Uint8Array, length: number, name: string): Float32Array<ArrayBuffer> {
  return asFloats(checked(bytes, 4 * length, `scalar ${name}`)).slice();
}

function rankColumn(bytes: Uint8Array, length: number): Uint32Array<ArrayBuffer> | null {
  if (bytes.length === 0) return null;
  checked(bytes, 4 * length, "ranks");
  return new Uint32Array(bytes.buffer, bytes.byteOffset, length).slice();
}
