// SPDX-License-Identifier: Apache-2.0
// Decodes any Draco point cloud, and meshes, with draco3d, Draco's own decoder in WebAssembly, which is loaded when data first needs it.

import type { Decoder as DracoDecoder, DecoderBuffer, DracoModule, PointCloud } from "draco3d/draco_decoder_nodejs.js";

import { badPoints } from "../decoded_points";
import { asCurvecastError, CurvecastError } from "../errors";
import { asFloats, writeColours, writeNormals, writePositions } from "../columns";
import { badSurface } from "./mesh_header";
import { colour, normal, position, radius, type DracoAttribute } from "./header";
import type { Columns } from "./reader";
import { loadWasm } from "./wasm";

async function loadDecoder(): Promise<DracoModule> {
  const [wasmBinary, { default: createDecoder }] = await Promise.all([loadWasm(), import("draco3d/draco_decoder_nodejs.js")]);
  return createDecoder({ wasmBinary });
}

/// A mesh as it is in its file: 3 values each.
export interface DracoMesh {
  positions: Float32Array;
  colours: Uint8Array | null;
  triangles: Uint32Array;
}

/// Decodes clouds and meshes, one after the other. Rejects bad data with DATA_LOSS, and stays usable.
export class DracoLibrary {
  private loading: Promise<Decoding> | null = null;

  constructor(private readonly load: () => Promise<DracoModule> = loadDecoder) {}

  /// Writes the points of data whose header readHeader() has accepted; `radii` are those of the codes. Writes colours where `to` has them.
  read(bytes: Uint8Array, radii: Float32Array, to: Columns): Promise<void> {
    return this.use((decoding) => decoding.read(bytes, radii, to));
  }

  /// Reads a mesh whose header checkMeshHeader() has accepted. Rejects one of other numbers of vertices and triangles.
  readMesh(bytes: Uint8Array, vertices: number, triangles: number): Promise<DracoMesh> {
    return this.use((decoding) => decoding.readMesh(bytes, vertices, triangles));
  }

  private async use<T>(read: (decoding: Decoding) => T): Promise<T> {
    this.loading ??= this.load().then((draco) => new Decoding(draco));
    const loading = this.loading;
    try {
      return read(await loading);
    } catch (thrown) {
      if (thrown instanceof CurvecastError && thrown.code === "DATA_LOSS") throw thrown;
      // draco3d could not be loaded, or its WebAssembly has aborted and cannot be used any more: load it anew.
      if (this.loading === loading) this.loading = null;
      const error = asCurvecastError(thrown);
      throw error.code === "UNAVAILABLE" ? error : badPoints(error.message);
    }
  }
}

class Decoding {
  private scratch = 0; // its address in the decoder's memory
  private scratchBytes = 0;

  constructor(private readonly draco: DracoModule) {}

  read(bytes: Uint8Array, radii: Float32Array, to: Columns): void {
    const cloud = new this.draco.PointCloud();
    this.decode(bytes, cloud, (decoder, buffer) => {
      const status = decoder.DecodeBufferToPointCloud(buffer, cloud);
      if (!status.ok()) throw badPoints(status.error_msg());
      if (cloud.num_points() !== to.count) throw badPoints("Draco data holds another number of points than it claims");
      const column = (of: DracoAttribute) => this.column(decoder, cloud, of);
      // Each column is copied before the next one is read: all use the same memory.
      writePositions(asFloats(column(position)), to);
      writeNormals(asFloats(column(normal)), to);
      column(radius).forEach((code, i) => (to.positions[4 * i + 3] = radii[code]!));
      if (to.colours !== null) writeColours(column(colour), to.colours);
    });
  }

  readMesh(bytes: Uint8Array, vertices: number, triangles: number): DracoMesh {
    const { draco } = this;
    const mesh = new draco.Mesh();
    return this.decode(bytes, mesh, (decoder, buffer) => {
      const status = decoder.DecodeBufferToMesh(buffer, mesh);
      if (!status.ok()) throw badSurface(status.error_msg());
      if (mesh.num_points() !== vertices || mesh.num_faces() !== triangles) {
        throw badSurface(`Draco data of ${mesh.num_faces()} triangles and ${mesh.num_points()} vertices`);
      }
      if (decoder.GetAttributeId(mesh, draco.POSITION) < 0) throw badSurface("Draco data without positions");
      const hasColours = decoder.GetAttributeId(mesh, draco.COLOR) >= 0;
      const positions = asFloats(this.column(decoder, mesh, position)).slice();
      const colours = hasColours ? this.column(decoder, mesh, colour).slice() : null;
      const size = 12 * triangles;
      const address = this.reserve(size);
      if (!decoder.GetTrianglesUInt32Array(mesh, size, address)) throw badSurface("triangles that cannot be read");
      return { positions, colours, triangles: new Uint32Array(draco.HEAPU8.slice(address, address + size).buffer) };
    });
  }

  /// Hands bytes in the decoder's memory to `read`, and gives back what that used, `into` too.
  private decode<T>(bytes: Uint8Array, into: PointCloud, read: (decoder: DracoDecoder, buffer: DecoderBuffer) => T): T {
    const { draco } = this;
    const buffer = new draco.DecoderBuffer();
    const decoder = new draco.Decoder();
    try {
      const address = this.reserve(bytes.length);
      draco.HEAPU8.set(bytes, address);
      buffer.Init(address, bytes.length);
      return read(decoder, buffer);
    } finally {
      draco.destroy(into);
      draco.destroy(decoder);
      draco.destroy(buffer);
    }
  }

  /// Reads the values of an attribute into the decoder's memory.
  private column(decoder: DracoDecoder, cloud: PointCloud, { kind, type, components }: DracoAttribute): Uint8Array {
    const { draco } = this;
    const attribute = decoder.GetAttribute(cloud, decoder.GetAttributeId(cloud, kind));
    const bytes = cloud.num_points() * components * (type === position.type ? 4 : 1);
    const address = this.reserve(bytes);
    if (!decoder.GetAttributeDataArrayForAllPoints(cloud, attribute, type, bytes, address))
      throw badPoints("a Draco attribute that cannot be read");
    return draco.HEAPU8.subarray(address, address + bytes);
  }

  /// Returns the address of at least so many bytes of the decoder's memory, for one purpose at a time.
  private reserve(bytes: number): number {
    if (bytes > this.scratchBytes) {
      if (this.scratch !== 0) this.draco._free(this.scratch);
      this.scratchBytes = 2 * bytes;
      this.scratch = this.draco._malloc(this.scratchBytes);
      if (this.scratch === 0) throw badPoints("no memory for a block");
    }
    return this.scratch;
  }
}
