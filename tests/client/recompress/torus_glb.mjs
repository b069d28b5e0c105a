// A torus with normals and a texture, as a .glb file.
import { deflateSync } from "node:zlib";

const crcTable = Uint32Array.from({ length: 256 }, (_, n) => {
  for (let bit = 0; bit < 8; ++bit) n = n & 1 ? 0xedb88320 ^ (n >>> 1) : n >>> 1;
  return n >>> 0;
});

function crc(bytes) {
  let sum = 0xffffffff;
  for (const byte of bytes) sum = crcTable[(sum ^ byte) & 255] ^ (sum >>> 8);
  return (sum ^ 0xffffffff) >>> 0;
}

function pngChunk(type, data) {
  const chunk = Buffer.alloc(12 + data.length);
  chunk.writeUInt32BE(data.length);
  chunk.write(type, 4, "latin1");
  data.copy(chunk, 8);
  chunk.writeUInt32BE(crc(chunk.subarray(4, 8 + data.length)), 8 + data.length);
  return chunk;
}

/// A square picture; `colour`: of a place in it, each from 0 to 1.
function png(size, colour) {
  const row = 1 + 3 * size;
  const rows = Buffer.alloc(size * row);
  for (let y = 0; y < size; ++y) {
    for (let x = 0; x < size; ++x) Buffer.from(colour(x / size, y / size)).copy(rows, y * row + 1 + 3 * x);
  }
  const header = Buffer.alloc(13);
  header.writeUInt32BE(size, 0);
  header.writeUInt32BE(size, 4);
  header[8] = 8; // bits
  header[9] = 2; // red, green, blue
  const magic = Buffer.from("\x89PNG\r\n\x1a\n", "latin1");
  return Buffer.concat([magic, pngChunk("IHDR", header), pngChunk("IDAT", deflateSync(rows)), pngChunk("IEND", Buffer.alloc(0))]);
}

function padded(bytes, filler = 0) {
  return Buffer.concat([bytes, Buffer.alloc((4 - (bytes.length % 4)) % 4, filler)]);
}

function words(...values) {
  const bytes = Buffer.alloc(4 * values.length);
  values.forEach((value, i) => bytes.writeUInt32LE(value, 4 * i));
  return bytes;
}

function glb(json, parts) {
  let offset = 0;
  json.bufferViews = parts.map((part) => {
    const view = { buffer: 0, byteOffset: offset, byteLength: part.length };
    offset += padded(part).length;
    return view;
  });
  json.buffers = [{ byteLength: offset }];
  const binary = Buffer.concat(parts.map((part) => padded(part)));
  const text = padded(Buffer.from(JSON.stringify(json)), " ");
  return Buffer.concat([
    Buffer.from("glTF"),
    words(2, 28 + text.length + binary.length, text.length, 0x4e4f534a),
    text,
    words(binary.length, 0x004e4942),
    binary,
  ]);
}

/// Moved by its node; red and green of its texture grow around it.
export function torusGlb(around = 60, across = 40) {
  const positions = [];
  const normals = [];
  const coordinates = [];
  const indices = [];
  for (let i = 0; i <= around; ++i) {
    for (let j = 0; j <= across; ++j) {
      const u = (2 * Math.PI * (i % around)) / around; // exactly closed
      const v = (2 * Math.PI * (j % across)) / across;
      const radius = 3 + Math.cos(v);
      positions.push(radius * Math.cos(u), radius * Math.sin(u), Math.sin(v));
      normals.push(Math.cos(v) * Math.cos(u), Math.cos(v) * Math.sin(u), Math.sin(v));
      coordinates.push(i / around, j / across);
    }
  }
  for (let i = 0; i < around; ++i) {
    for (let j = 0; j < across; ++j) {
      const a = i * (across + 1) + j;
      const b = a + across + 1;
      indices.push(a, b, b + 1, a, b + 1, a + 1);
    }
  }
  const floats = Float32Array.from(positions);
  const axis = (k) => floats.filter((_, i) => i % 3 === k);
  const count = floats.length / 3;
  const json = {
    asset: { version: "2.0" },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0, translation: [5, 0, 0] }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0, NORMAL: 1, TEXCOORD_0: 2 }, indices: 3, material: 0 }] }],
    materials: [{ pbrMetallicRoughness: { baseColorTexture: { index: 0 } } }],
    textures: [{ source: 0 }],
    images: [{ bufferView: 4, mimeType: "image/png" }],
    accessors: [
      {
        bufferView: 0,
        componentType: 5126,
        count,
        type: "VEC3",
        min: [0, 1, 2].map((k) => Math.min(...axis(k))),
        max: [0, 1, 2].map((k) => Math.max(...axis(k))),
      },
      { bufferView: 1, componentType: 5126, count, type: "VEC3" },
      { bufferView: 2, componentType: 5126, count, type: "VEC2" },
      { bufferView: 3, componentType: 5123, count: indices.length, type: "SCALAR" },
    ],
  };
  const bytes = (array) => Buffer.from(array.buffer);
  const picture = png(64, (x, y) => [255 * Math.abs(1 - 2 * x), 255 * Math.abs(1 - 2 * y), 128]);
  return glb(json, [
    bytes(floats),
    bytes(Float32Array.from(normals)),
    bytes(Float32Array.from(coordinates)),
    bytes(Uint16Array.from(indices)),
    picture,
  ]);
}
