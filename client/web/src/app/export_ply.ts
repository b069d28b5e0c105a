// SPDX-License-Identifier: Apache-2.0
// The points of a store, or a mesh, as a binary PLY file.

import type { PointStore, TriangleMesh } from "../stream";

/// Points, and the order that a file has them in.
export interface ListedPoints extends PointStore {
  /// Lists the slots of the points.
  order(): Uint32Array;
}

/// A PLY property: its name and type, and its value for the point in a slot.
interface Property {
  name: string;
  type: "double" | "float" | "uchar" | "uint";
  valueOf: (slot: number) => number;
}

const sizes = { double: 8, float: 4, uchar: 1, uint: 4 };

const triangleBytes = 13; // a byte for the number of corners, then these

function propertiesOf(store: ListedPoints): Property[] {
  const { positions, normals, colours, curvatures, ranks, directions, scalars, origin } = store;
  const isFar = origin.some((value) => value !== 0);
  const column = (names: string[], type: Property["type"], valueAt: (slot: number, i: number) => number) =>
    names.map((name, i): Property => ({ name, type, valueOf: (slot) => valueAt(slot, i) }));
  return [
    ...column(["x", "y", "z"], isFar ? "double" : "float", (slot, axis) => positions[4 * slot + axis]! + origin[axis]!),
    ...column(["nx", "ny", "nz"], "float", (slot, axis) => normals[4 * slot + axis]! / 127),
    ...(colours === null ? [] : column(["red", "green", "blue"], "uchar", (slot, channel) => colours[4 * slot + channel]!)),
    ...column(["radius"], "float", (slot) => positions[4 * slot + 3]!),
    ...(curvatures === null ? [] : column(["curvature_min", "curvature_max"], "float", (slot, i) => curvatures[2 * slot + i]!)),
    ...(ranks === null ? [] : column(["rank"], "uint", (slot) => ranks[slot]!)),
    ...(directions === null ? [] : column(directionNames, "float", (slot, axis) => directions[3 * slot + axis]!)),
    ...scalars.flatMap(({ name, values }) => column([scalarName(name)], "float", (slot) => values[slot]!)),
  ];
}

const directionNames = ["direction_min_x", "direction_min_y", "direction_min_z"];

/// Nothing in a name may end a word of the header; each byte of the name counts, as in the command's files.
function scalarName(name: string): string {
  const bytes = new TextEncoder().encode(name);
  return "scalar_" + Array.from(bytes, (byte) => (byte > 0x20 && byte < 0x7f ? String.fromCharCode(byte) : "_")).join("");
}

function put(view: DataView, at: number, type: Property["type"], value: number): void {
  if (type === "double") view.setFloat64(at, value, true);
  else if (type === "float") view.setFloat32(at, value, true);
  else if (type === "uint") view.setUint32(at, value, true);
  else view.setUint8(at, value);
}

/// Writes properties of all points, in their order.
function rowsOf(store: ListedPoints, properties: readonly Property[]): DataView<ArrayBuffer> {
  const stride = properties.reduce((sum, { type }) => sum + sizes[type], 0);
  const view = new DataView(new ArrayBuffer(store.count * stride));
  let at = 0;
  for (const slot of store.order()) {
    for (const { type, valueOf } of properties) {
      put(view, at, type, valueOf(slot));
      at += sizes[type];
    }
  }
  return view;
}

function headerOf(store: ListedPoints, properties: readonly Property[], more = ""): string {
  const lines = properties.map(({ name, type }) => `property ${type} ${name}\n`).join("");
  const format = "ply\nformat binary_little_endian 1.0\ncomment Curvecast\n";
  return `${format}element vertex ${store.count}\n${lines}${more}end_header\n`;
}

function fileOf(...parts: BlobPart[]): Blob {
  return new Blob(parts, { type: "application/octet-stream" });
}

/// Writes the points as a little-endian PLY file: x y z nx ny nz, red green blue where there are colours, radius, then curvatures,
/// ranks, directions and the mesh's scalars where there are any. Positions are in the mesh's own frame, as doubles where the points
/// have an origin. The points are in the order that they list. `curvecast sample` writes the same.
export function plyOf(store: ListedPoints): Blob {
  const properties = propertiesOf(store);
  return fileOf(headerOf(store, properties), rowsOf(store, properties));
}

/// Writes a mesh as a little-endian PLY file: its vertices as plyOf() does, without radii, and its triangles.
export function meshPlyOf({ vertices, triangles }: TriangleMesh): Blob {
  const properties = propertiesOf(vertices).filter(({ name }) => name !== "radius");
  const faces = new DataView(new ArrayBuffer((triangles.length / 3) * triangleBytes));
  triangles.forEach((vertex, i) => {
    const at = Math.floor(i / 3) * triangleBytes;
    if (i % 3 === 0) faces.setUint8(at, 3);
    faces.setUint32(at + 1 + 4 * (i % 3), vertex, true);
  });
  const more = `element face ${triangles.length / 3}\nproperty list uchar uint vertex_indices\n`;
  return fileOf(headerOf(vertices, properties, more), rowsOf(vertices, properties), faces);
}
