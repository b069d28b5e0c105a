// SPDX-License-Identifier: Apache-2.0
// What is used of the draco3d package, which brings no types.

declare module "draco3d/draco_decoder_nodejs.js" {
  export interface Status {
    ok(): boolean;
    error_msg(): string;
  }
  export interface PointCloud {
    num_points(): number;
  }
  export interface Mesh extends PointCloud {
    num_faces(): number;
  }
  export interface PointAttribute {
    num_components(): number;
    data_type(): number;
  }
  export interface DecoderBuffer {
    Init(address: number, size: number): void;
  }
  export interface Decoder {
    DecodeBufferToPointCloud(buffer: DecoderBuffer, cloud: PointCloud): Status;
    DecodeBufferToMesh(buffer: DecoderBuffer, mesh: Mesh): Status;
    GetTrianglesUInt32Array(mesh: Mesh, bytes: number, address: number): boolean;
    GetAttributeId(cloud: PointCloud, kind: number): number;
    GetAttribute(cloud: PointCloud, id: number): PointAttribute;
    GetAttributeDataArrayForAllPoints(
      cloud: PointCloud,
      attribute: PointAttribute,
      type: number,
      bytes: number,
      address: number,
    ): boolean;
  }
  export interface DracoModule {
    readonly POSITION: number;
    readonly NORMAL: number;
    readonly COLOR: number;
    readonly GENERIC: number;
    readonly DT_UINT8: number;
    readonly DT_FLOAT32: number;
    readonly HEAPU8: Uint8Array<ArrayBuffer>;
    Decoder: new () => Decoder;
    DecoderBuffer: new () => DecoderBuffer;
    PointCloud: new () => PointCloud;
    Mesh: new () => Mesh;
    destroy(object: object): void;
    _malloc(bytes: number): number;
    _free(address: number): void;
  }
  export default function createDecoder(options: { wasmBinary: ArrayBuffer }): Promise<DracoModule>;
}
