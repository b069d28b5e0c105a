// draco3d's decoder and encoder in Node, and clouds and meshes made with the latter.

import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

import createDecoder, { type DracoModule } from "draco3d/draco_decoder_nodejs.js";
import createEncoder from "draco3d/draco_encoder_nodejs.js";

const require = createRequire(new URL("../../../../client/web/package.json", import.meta.url));

function wasmOf(name: string): ArrayBuffer {
  const bytes = readFileSync(require.resolve(`draco3d/${name}.wasm`));
  return bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length);
}

export function loadDecoder(): Promise<DracoModule> {
  return createDecoder({ wasmBinary: wasmOf("draco_decoder") });
}

export interface CloudOptions {
  points: number;
  positionBits: number;
  normalBits: number;
  speed: number; // 0 .. 10: the faster the less compressed
  noise: number; // how far a point is from the one before, in sizes of the cloud
  colours: boolean;
  others: boolean; // an attribute that blocks do not have
}

/// Encodes a cloud as a server might: a walk on a sphere, with normals, radii and perhaps colours. The same for the same options.
export async function encodedCloud(options: CloudOptions): Promise<Uint8Array<ArrayBuffer>> {
  const draco = await createEncoder({ wasmBinary: wasmOf("draco_encoder") });
  const random = randomNumbers(options.points);
  const positions = new Float32Array(3 * options.points);
  const normals = new Float32Array(3 * options.points);
  let [latitude, longitude] = [0, 0];
  for (let i = 0; i < options.points; ++i) {
    latitude += options.noise * (random() - 0.5);
    longitude += options.noise * (random() - 0.5);
    const normal = [Math.cos(latitude) * Math.cos(longitude), Math.cos(latitude) * Math.sin(longitude), Math.sin(latitude)];
    normals.set(normal, 3 * i);
    positions.set(
      normal.map((value) => 10 * value - 3),
      3 * i,
    );
  }
  const bytes = (count: number) => Uint8Array.from({ length: count }, () => 255 * random() ** 3);
  const [cloud, builder, encoder, result] = [
    new draco.PointCloud(),
    new draco.PointCloudBuilder(),
    new draco.Encoder(),
    new draco.DracoInt8Array(),
  ];
  builder.AddFloatAttribute(cloud, draco.POSITION, options.points, 3, positions);
  builder.AddFloatAttribute(cloud, draco.NORMAL, options.points, 3, normals);
  builder.AddUInt8Attribute(cloud, draco.GENERIC, options.points, 1, bytes(options.points));
  if (options.colours) builder.AddUInt8Attribute(cloud, draco.COLOR, options.points, 3, bytes(3 * options.points));
  if (options.others) builder.AddUInt8Attribute(cloud, draco.TEX_COORD, options.points, 2, bytes(2 * options.points));
  encoder.SetEncodingMethod(draco.POINT_CLOUD_SEQUENTIAL_ENCODING);
  encoder.SetSpeedOptions(options.speed, options.speed);
  encoder.SetAttributeQuantization(draco.POSITION, options.positionBits);
  encoder.SetAttributeQuantization(draco.NORMAL, options.normalBits);
  const length = encoder.EncodePointCloudToDracoBuffer(cloud, false, result);
  const encoded = Uint8Array.from({ length }, (_, i) => result.GetValue(i));
  for (const object of [cloud, builder, encoder, result]) draco.destroy(object);
  return encoded;
}

/// A mesh: 3 values each.
export interface PlainMesh {
  positions: number[];
  triangles: number[];
  colours?: number[];
}

/// Encodes a mesh as the server does; `isListed`: by Draco's other method. The file has other numbers of vertices and triangles.
export async function encodedMesh(
  { positions, triangles, colours }: PlainMesh,
  isListed = false,
): Promise<Uint8Array<ArrayBuffer>> {
  const draco = await createEncoder({ wasmBinary: wasmOf("draco_encoder") });
  const [mesh, builder, encoder, result] = [
    new draco.Mesh(),
    new draco.MeshBuilder(),
    new draco.Encoder(),
    new draco.DracoInt8Array(),
  ];
  const vertices = positions.length / 3;
  builder.AddFacesToMesh(mesh, triangles.length / 3, Uint32Array.from(triangles));
  builder.AddFloatAttribute(mesh, draco.POSITION, vertices, 3, Float32Array.from(positions));
  if (colours !== undefined) builder.AddUInt8Attribute(mesh, draco.COLOR, vertices, 3, Uint8Array.from(colours));
  encoder.SetEncodingMethod(isListed ? draco.MESH_SEQUENTIAL_ENCODING : draco.MESH_EDGEBREAKER_ENCODING);
  encoder.SetAttributeQuantization(draco.POSITION, 14);
  const length = encoder.EncodeMeshToDracoBuffer(mesh, result);
  const encoded = Uint8Array.from({ length }, (_, i) => result.GetValue(i));
  for (const object of [mesh, builder, encoder, result]) draco.destroy(object);
  return encoded;
}

function randomNumbers(seed: number): () => number {
  let state = seed;
  return () => (state = (Math.imul(state, 1_664_525) + 1_013_904_223) >>> 0) / 2 ** 32;
}
