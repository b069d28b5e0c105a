// SPDX-License-Identifier: Apache-2.0
// Triangle meshes that a server makes of points: checks their messages, and joins them.

import type { MeshChunk, PointBlock, Progress, RemeshInfo, RemeshResponse } from "../gen/curvecast/v1/curvecast_pb";
import type { PointDecoder } from "./decoder";
import { CurvecastError } from "./errors";
import { StreamedPoints } from "./point_store";
import { maxPoints } from "./protocol";

/// A manifold mesh of a surface.
export interface TriangleMesh {
  readonly vertices: StreamedPoints; // vertex i in slot i
  readonly triangles: Uint32Array; // 3 each: vertices, counter-clockwise seen from outside
}

const mostTriangles = 4 * maxPoints; // twice those of a surface without handles
const triangleBytes = 12;

function badMesh(why: string): CurvecastError {
  return new CurvecastError("DATA_LOSS", `the server sent a bad mesh: ${why}`);
}

/// Joins the messages of an answer. Rejects with DATA_LOSS at the first one that breaks the protocol, so that no more is kept than was
/// announced.
export async function readMesh(
  responses: AsyncIterable<RemeshResponse>,
  decoder: PointDecoder,
  onProgress?: (progress: Progress) => void,
): Promise<TriangleMesh> {
  let parts: MeshParts | null = null;
  for await (const { update } of responses) {
    if (update.case === "progress") onProgress?.(update.value);
    if (update.case === "info") {
      if (parts !== null) throw badMesh("a second beginning");
      parts = new MeshParts(update.value);
    }
    if (update.case === "chunk") {
      if (parts === null) throw badMesh("a part before its beginning");
      parts.add(update.value);
    }
  }
  if (parts === null) throw badMesh("none");
  return parts.join(decoder);
}

/// The parts of one mesh, never more than its beginning says.
class MeshParts {
  private readonly blocks: PointBlock[] = [];
  private readonly triangles: Uint8Array[] = [];
  private vertexCount = 0; // so far
  private triangleCount = 0; // so far

  constructor(private readonly info: RemeshInfo) {
    if (info.vertices > maxPoints || info.triangles > mostTriangles) throw badMesh(`one of ${this.announced}`);
  }

  add({ vertices, triangles }: MeshChunk): void {
    if (vertices !== undefined) this.blocks.push(vertices);
    this.vertexCount += vertices?.count ?? 0;
    if (triangles.length % triangleBytes !== 0) throw badMesh("a part of a triangle");
    if (triangles.length > 0) this.triangles.push(triangles);
    this.triangleCount += triangles.length / triangleBytes;
    if (this.vertexCount > this.info.vertices || this.triangleCount > this.info.triangles) throw this.miscounted();
  }

  async join(decoder: PointDecoder): Promise<TriangleMesh> {
    if (BigInt(this.vertexCount) !== this.info.vertices || BigInt(this.triangleCount) !== this.info.triangles) {
      throw this.miscounted();
    }
    const vertices = new StreamedPoints();
    vertices.replace(await decoder.decode(this.blocks));
    const bytes = new Uint8Array(triangleBytes * this.triangleCount);
    let at = 0;
    for (const part of this.triangles) {
      bytes.set(part, at);
      at += part.length;
    }
    const triangles = new Uint32Array(bytes.buffer);
    checkTriangles(triangles, this.vertexCount);
    return { vertices, triangles };
  }

  private get announced(): string {
    return `${this.info.vertices} vertices and ${this.info.triangles} triangles`;
  }

  private miscounted(): CurvecastError {
    return badMesh(`${this.vertexCount} vertices and ${this.triangleCount} triangles of ${this.announced}`);
  }
}

function checkTriangles(triangles: Uint32Array, vertexCount: number): void {
  for (let i = 0; i < triangles.length; i += 3) {
    const a = triangles[i]!,
      b = triangles[i + 1]!,
      c = triangles[i + 2]!;
    if (a >= vertexCount || b >= vertexCount || c >= vertexCount || a === b || b === c || c === a) {
      throw badMesh(`a triangle that is not between three of ${vertexCount} vertices`);
    }
  }
}
