// Blocks of points, Draco or raw, to the arrays of a PointStore. Runs in a worker; needs nothing of a browser.

import type { DracoModule, PointCloud } from "draco3d/draco_decoder_nodejs.js";

import type { PointAttributes, PointBlock, RawPoints } from "../gen/curvecast/v1/curvecast_pb";
import { badPoints, type DecodedPoints } from "./decoded_points";
import { claimedPoints } from "./draco_header";

/// A block as it goes to a worker: plain, with bytes of its own.
export interface EncodedBlock {
  count: number;
  origin: [number, number, number];
  draco: { data: Uint8Array<ArrayBuffer>; radiusMin: number; radiusMax: number } | null;
  raw: { positions: Uint8Array; normals: Uint8Array; radii: Uint8Array; colours: Uint8Array } | null;
  curvatures: Uint8Array;
  ranks: Uint8Array;
}

/// A block of a message, with copies of its bytes. Throws where it can be no block.
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
  };
}

/// The buffers of a block or of its points, for a transfer to another thread.
export function buffersOf(holder: EncodedBlock | DecodedPoints): ArrayBuffer[] {
  const arrays = Object.values(holder).flatMap((value: unknown) =>
    ArrayBuffer.isView(value)
      ? [value]
      : value !== null && typeof value === "object"
        ? Object.values(value).filter(ArrayBuffer.isView)
        : [],
  );
  return [...new Set(arrays.map((array) => array.buffer))].filter((buffer) => buffer instanceof ArrayBuffer);
}

/// Decodes one block after the other. Throws a CurvecastError for bad data, and stays usable.
export class BlockDecoder {
  private scratch = 0; // address in the decoder's memory
  private scratchBytes = 0;
  private radii = new Float32Array(256);
  private radiusMin = 0;
  private radiusMax = 0;

  constructor(private readonly draco: DracoModule) {}

  decode(block: EncodedBlock): DecodedPoints {
    const points: DecodedPoints = {
      count: block.count,
      origin: block.origin,
      places: new Float32Array(0),
      normals: new Int8Array(0),
      colours: null,
      curvatures: floatColumn(block.curvatures, 2 * block.count, "curvatures"),
      ranks: rankColumn(block.ranks, block.count),
    };
    if (block.draco !== null) this.decodeDraco(block.draco, points);
    else if (block.raw !== null) decodeRaw(block.raw, points);
    else throw badPoints("a block that is neither Draco nor raw");
    return points;
  }

  private decodeDraco(block: NonNullable<EncodedBlock["draco"]>, points: DecodedPoints): void {
    const claimed = claimedPoints(block.data);
    if (claimed !== points.count) throw badPoints(`Draco data of ${claimed} points in a block of ${points.count}`);
    const { draco } = this;
    const buffer = new draco.DecoderBuffer();
    const decoder = new draco.Decoder();
    const cloud = new draco.PointCloud();
    try {
      const address = this.reserve(block.data.length);
      draco.HEAPU8.set(block.data, address);
      buffer.Init(address, block.data.length);
      const status = decoder.DecodeBufferToPointCloud(buffer, cloud);
      if (!status.ok()) throw badPoints(status.error_msg());
      if (cloud.num_points() !== points.count) throw badPoints("Draco data holds another number of points than it claims");
      const read = (kind: number, type: number, components: number) => this.column(decoder, cloud, kind, type, components);
      points.places = new Float32Array(4 * points.count);
      points.normals = new Int8Array(4 * points.count);
      // Each is copied before the next is read: all use the same memory.
      writePositions(asFloats(read(draco.POSITION, draco.DT_FLOAT32, 3)), points);
      writeNormals(asFloats(read(draco.NORMAL, draco.DT_FLOAT32, 3)), points);
      this.writeRadii(read(draco.GENERIC, draco.DT_UINT8, 1), block.radiusMin, block.radiusMax, points);
      if (decoder.GetAttributeId(cloud, draco.COLOR) >= 0) {
        points.colours = opaque(read(draco.COLOR, draco.DT_UINT8, 3), points.count);
      }
    } finally {
      draco.destroy(cloud);
      draco.destroy(decoder);
      draco.destroy(buffer);
    }
  }

  /// The values of an attribute, in the decoder's memory.
  private column(
    decoder: InstanceType<DracoModule["Decoder"]>,
    cloud: PointCloud,
    kind: number,
    type: number,
    components: number,
  ): Uint8Array {
    const { draco } = this;
    const id = decoder.GetAttributeId(cloud, kind);
    if (id < 0) throw badPoints("Draco data that lacks an attribute");
    const attribute = decoder.GetAttribute(cloud, id);
    if (attribute.num_components() !== components || attribute.data_type() !== type)
      throw badPoints("a Draco attribute of another type");
    const bytes = cloud.num_points() * components * (type === draco.DT_FLOAT32 ? 4 : 1);
    const address = this.reserve(bytes);
    if (!decoder.GetAttributeDataArrayForAllPoints(cloud, attribute, type, bytes, address))
      throw badPoints("a Draco attribute that cannot be read");
    return draco.HEAPU8.subarray(address, address + bytes);
  }

  /// At least so many bytes of the decoder's memory, for one purpose at a time.
  private reserve(bytes: number): number {
    if (bytes > this.scratchBytes) {
      if (this.scratch !== 0) this.draco._free(this.scratch);
      this.scratchBytes = 2 * bytes;
      this.scratch = this.draco._malloc(this.scratchBytes);
      if (this.scratch === 0) throw badPoints("no memory for a block");
    }
    return this.scratch;
  }

  private writeRadii(codes: Uint8Array, min: number, max: number, points: DecodedPoints): void {
    if (!(min > 0 && min <= max && Number.isFinite(max))) throw badPoints(`radii from ${min} to ${max}`);
    if (min !== this.radiusMin || max !== this.radiusMax) {
      this.radii = Float32Array.from({ length: 256 }, (_, code) => min * (max / min) ** (code / 255));
      this.radiusMin = min;
      this.radiusMax = max;
    }
    for (let i = 0; i < points.count; ++i) points.places[4 * i + 3] = this.radii[codes[i]!]!;
  }
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
  points.places = new Float32Array(4 * points.count);
  points.normals = new Int8Array(4 * points.count);
  writePositions(asFloats(positions), points);
  writeNormals(asFloats(normals), points);
  asFloats(radii).forEach((radius, i) => {
    if (!(radius >= 0 && radius < Infinity)) throw badPoints(`radius ${radius}`);
    points.places[4 * i + 3] = radius;
  });
  if (raw.colours.length > 0) points.colours = opaque(checked(raw.colours, 3 * points.count, "colours"), points.count);
}

function checked(bytes: Uint8Array, expected: number, what: string): Uint8Array {
  if (bytes.length !== expected) throw badPoints(`${bytes.length} bytes of ${what} where ${expected} belong`);
  return bytes;
}

function asFloats(bytes: Uint8Array): Float32Array {
  return new Float32Array(bytes.buffer, bytes.byteOffset, bytes.length / 4);
}

function floatColumn(bytes: Uint8Array, length: number, what: string): Float32Array<ArrayBuffer> | null {
  if (bytes.length === 0) return null;
  const values = asFloats(checked(bytes, 4 * length, what)).slice();
  if (!values.every(Number.isFinite)) throw badPoints(`${what} that are not finite`);
  return values;
}

function rankColumn(bytes: Uint8Array, length: number): Uint32Array<ArrayBuffer> | null {
  if (bytes.length === 0) return null;
  checked(bytes, 4 * length, "ranks");
  return new Uint32Array(bytes.buffer, bytes.byteOffset, length).slice();
}

function writePositions(positions: Float32Array, { count, places }: DecodedPoints): void {
  let sum = 0; // not 0 where one of them is not finite
  for (let i = 0; i < count; ++i) {
    const x = positions[3 * i]!,
      y = positions[3 * i + 1]!,
      z = positions[3 * i + 2]!;
    places[4 * i] = x;
    places[4 * i + 1] = y;
    places[4 * i + 2] = z;
    sum += 0 * x + 0 * y + 0 * z;
  }
  if (sum !== 0) throw badPoints("a position that is not finite");
}

function writeNormals(normals: Float32Array, points: DecodedPoints): void {
  let sum = 0;
  for (let i = 0; i < points.count; ++i) {
    const x = normals[3 * i]!,
      y = normals[3 * i + 1]!,
      z = normals[3 * i + 2]!;
    points.normals[4 * i] = Math.round(127 * x);
    points.normals[4 * i + 1] = Math.round(127 * y);
    points.normals[4 * i + 2] = Math.round(127 * z);
    sum += 0 * x + 0 * y + 0 * z;
  }
  if (sum !== 0) throw badPoints("a normal that is not finite");
}

function opaque(rgb: Uint8Array, count: number): Uint8Array<ArrayBuffer> {
  const rgba = new Uint8Array(4 * count).fill(255);
  for (let i = 0; i < count; ++i) {
    rgba[4 * i] = rgb[3 * i]!;
    rgba[4 * i + 1] = rgb[3 * i + 1]!;
    rgba[4 * i + 2] = rgb[3 * i + 2]!;
  }
  return rgba;
}
