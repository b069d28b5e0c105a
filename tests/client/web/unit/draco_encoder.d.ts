// What the tests use of draco3d's encoder, which brings no types.

declare module "draco3d/draco_encoder_nodejs.js" {
  type Cloud = object;
  interface Bytes {
    GetValue(index: number): number;
  }
  interface Encoder {
    SetEncodingMethod(method: number): void;
    SetSpeedOptions(encoding: number, decoding: number): void;
    SetAttributeQuantization(kind: number, bits: number): void;
    EncodeMeshToDracoBuffer(mesh: Cloud, bytes: Bytes): number;
    EncodePointCloudToDracoBuffer(cloud: Cloud, deduplicate: boolean, bytes: Bytes): number;
  }
  interface Builder {
    AddFloatAttribute(cloud: Cloud, kind: number, points: number, components: number, values: Float32Array): number;
    AddUInt8Attribute(cloud: Cloud, kind: number, points: number, components: number, values: Uint8Array): number;
  }
  interface MeshBuilder extends Builder {
    AddFacesToMesh(mesh: Cloud, faces: number, indices: Uint32Array): boolean;
  }
  export interface EncoderModule {
    readonly POSITION: number;
    readonly NORMAL: number;
    readonly COLOR: number;
    readonly GENERIC: number;
    readonly TEX_COORD: number;
    readonly POINT_CLOUD_SEQUENTIAL_ENCODING: number;
    readonly MESH_SEQUENTIAL_ENCODING: number;
    readonly MESH_EDGEBREAKER_ENCODING: number;
    Encoder: new () => Encoder;
    PointCloudBuilder: new () => Builder;
    PointCloud: new () => Cloud;
    MeshBuilder: new () => MeshBuilder;
    Mesh: new () => Cloud;
    DracoInt8Array: new () => Bytes;
    destroy(object: object): void;
  }
  export default function createEncoder(options: { wasmBinary: ArrayBuffer }): Promise<EncoderModule>;
}
