// SPDX-License-Identifier: Apache-2.0
// Normals of the corners of triangles, with creases, as core/mesh/crease_normals has them: a corner's normal is the mean, by their
// angles, of those faces around its vertex that it is joined to by edges that are no creases.

const tolerance = 0.01; // degrees: edges of as much as the limit are all the same, whatever floats make of them

/// Vertices, each with one normal, and triangles between them. `sources`: which of the vertices before each of them was.
export interface ShadedMesh {
  positions: Float32Array<ArrayBuffer>; // x, y, z of each vertex
  normals: Float32Array<ArrayBuffer>; // unit length, or 0 where all faces are degenerate
  triangles: Uint32Array<ArrayBuffer>;
  sources: Uint32Array<ArrayBuffer>;
}

/// Gives each vertex a normal. Vertices at creases become several, those without triangles go. `degrees`, 0 .. 180: faces whose normals
/// are further apart meet at a crease. Precondition: indices are in range. Takes time and memory in proportion to the mesh.
export function withNormals(positions: Float32Array, triangles: Uint32Array, degrees: number): ShadedMesh {
  const faceNormals = faceNormalsOf(positions, triangles);
  const parts = joinedCorners(positions.length / 3, triangles, faceNormals, creaseCosine(degrees));
  // Vertices in the order in which triangles first use them: those are near each other in memory that are so on the surface.
  const vertexOfPart = new Uint32Array(triangles.length); // counted from 1; 0: none yet
  const shaded = new Uint32Array(triangles.length);
  let count = 0;
  for (let corner = 0; corner < triangles.length; ++corner) {
    const part = rootOf(parts, corner);
    if (vertexOfPart[part] === 0) vertexOfPart[part] = ++count;
    shaded[corner] = vertexOfPart[part]! - 1;
  }
  const sources = new Uint32Array(count);
  for (let corner = 0; corner < triangles.length; ++corner) sources[shaded[corner]!] = triangles[corner]!;
  const places = new Float32Array(3 * count);
  for (let vertex = 0; vertex < count; ++vertex) {
    const from = 3 * sources[vertex]!;
    for (let k = 0; k < 3; ++k) places[3 * vertex + k] = positions[from + k]!;
  }
  return { positions: places, normals: meanNormals(places, shaded, faceNormals), triangles: shaded, sources };
}

function creaseCosine(degrees: number): number {
  if (degrees <= 0) return 2;
  if (degrees >= 180) return -2;
  return Math.cos((Math.min(degrees + tolerance, 180) * Math.PI) / 180);
}

/// Of unit length; 0 of degenerate triangles.
function faceNormalsOf(positions: Float32Array, triangles: Uint32Array): Float32Array {
  const normals = new Float32Array(triangles.length);
  for (let at = 0; at < triangles.length; at += 3) {
    const [a, b, c] = [3 * triangles[at]!, 3 * triangles[at + 1]!, 3 * triangles[at + 2]!];
    const ux = positions[b]! - positions[a]!,
      uy = positions[b + 1]! - positions[a + 1]!,
      uz = positions[b + 2]! - positions[a + 2]!;
    const vx = positions[c]! - positions[a]!,
      vy = positions[c + 1]! - positions[a + 1]!,
      vz = positions[c + 2]! - positions[a + 2]!;
    const x = uy * vz - uz * vy,
      y = uz * vx - ux * vz,
      z = ux * vy - uy * vx;
    setUnit(normals, at, x, y, z);
  }
  return normals;
}

/// Writes the direction of a vector; leaves what is there where it has none.
function setUnit(normals: Float32Array, at: number, x: number, y: number, z: number): void {
  const length = Math.sqrt(x * x + y * y + z * z);
  if (!(length > 0)) return;
  normals[at] = x / length;
  normals[at + 1] = y / length;
  normals[at + 2] = z / length;
}

/// Joins the corners at both ends of every edge that is no crease. Returns a parent of each corner: see rootOf().
function joinedCorners(vertices: number, triangles: Uint32Array, faceNormals: Float32Array, cosine: number): Uint32Array {
  const joined = new Uint32Array(triangles.length);
  for (let corner = 0; corner < joined.length; ++corner) joined[corner] = corner;
  const next = (corner: number): number => (corner % 3 === 2 ? corner - 2 : corner + 1);
  // Edges, named by the corners that they leave, in an order that brings the two of a pair together.
  const lower = (edge: number): number => Math.min(triangles[edge]!, triangles[next(edge)]!);
  const higher = (edge: number): number => Math.max(triangles[edge]!, triangles[next(edge)]!);
  const edges = sortedBy(lower, vertices, sortedBy(higher, vertices, joined.slice()));
  for (let i = 0; i < edges.length;) {
    const edge = edges[i]!;
    let end = i + 1;
    while (end < edges.length && lower(edges[end]!) === lower(edge) && higher(edges[end]!) === higher(edge)) ++end;
    const twin = edges[i + 1]!;
    // Edges of one face, or of more than two, join nothing, nor do those of faces that are turned against each other.
    if (end === i + 2 && triangles[edge] === triangles[next(twin)] && isSmooth(faceNormals, edge, twin, cosine)) {
      join(joined, edge, next(twin));
      join(joined, next(edge), twin);
    }
    i = end;
  }
  return joined;
}

/// Degenerate faces have no normal, and meet others at no crease.
function isSmooth(faceNormals: Float32Array, edge: number, twin: number, cosine: number): boolean {
  const [a, b] = [edge - (edge % 3), twin - (twin % 3)];
  const [ax, ay, az] = [faceNormals[a]!, faceNormals[a + 1]!, faceNormals[a + 2]!];
  const [bx, by, bz] = [faceNormals[b]!, faceNormals[b + 1]!, faceNormals[b + 2]!];
  if ((ax === 0 && ay === 0 && az === 0) || (bx === 0 && by === 0 && bz === 0)) return cosine <= 1;
  return ax * bx + ay * by + az * bz >= cosine;
}

/// Sorts by a key below `keys`, and keeps the order of what has the same.
function sortedBy(key: (edge: number) => number, keys: number, edges: Uint32Array): Uint32Array {
  const starts = new Uint32Array(keys + 1);
  for (const edge of edges) ++starts[key(edge) + 1]!;
  for (let k = 0; k < keys; ++k) starts[k + 1]! += starts[k]!;
  const sorted = new Uint32Array(edges.length);
  for (const edge of edges) sorted[starts[key(edge)]!++] = edge;
  return sorted;
}

/// Returns the corner that stands for all that a corner is joined to, and shortens the way there.
function rootOf(parents: Uint32Array, corner: number): number {
  let at = corner;
  while (parents[at] !== at) at = parents[at] = parents[parents[at]!]!;
  return at;
}

function join(parents: Uint32Array, a: number, b: number): void {
  const [one, other] = [rootOf(parents, a), rootOf(parents, b)];
  parents[Math.max(one, other)] = Math.min(one, other);
}

/// The means of the normals of each vertex's faces by their angles there.
function meanNormals(positions: Float32Array, triangles: Uint32Array, faceNormals: Float32Array): Float32Array<ArrayBuffer> {
  const normals = new Float32Array(positions.length);
  for (let at = 0; at < triangles.length; at += 3) {
    for (let k = 0; k < 3; ++k) {
      const to = 3 * triangles[at + k]!;
      const angle = angleAt(positions, to, 3 * triangles[at + ((k + 1) % 3)]!, 3 * triangles[at + ((k + 2) % 3)]!);
      normals[to]! += angle * faceNormals[at]!;
      normals[to + 1]! += angle * faceNormals[at + 1]!;
      normals[to + 2]! += angle * faceNormals[at + 2]!;
    }
  }
  for (let at = 0; at < normals.length; at += 3) {
    setUnit(normals, at, normals[at]!, normals[at + 1]!, normals[at + 2]!);
  }
  return normals;
}

/// The angle at `a` of the triangle between the places that begin at three indices.
function angleAt(positions: Float32Array, a: number, b: number, c: number): number {
  const ux = positions[b]! - positions[a]!,
    uy = positions[b + 1]! - positions[a + 1]!,
    uz = positions[b + 2]! - positions[a + 2]!;
  const vx = positions[c]! - positions[a]!,
    vy = positions[c + 1]! - positions[a + 1]!,
    vz = positions[c + 2]! - positions[a + 2]!;
  const x = uy * vz - uz * vy,
    y = uz * vx - ux * vz,
    z = ux * vy - uy * vx;
  return Math.atan2(Math.sqrt(x * x + y * y + z * z), ux * vx + uy * vy + uz * vz);
}
