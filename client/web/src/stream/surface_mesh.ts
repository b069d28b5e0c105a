// SPDX-License-Identifier: Apache-2.0
// The surface's own triangles, as a server sends them: checks its messages, and joins them.

import type { GetSurfaceResponse, SurfaceInfo } from "../gen/curvecast/v1/curvecast_pb";
import type { Decoder } from "./decoder";
import { badSurface } from "./draco/mesh_header";
import { maxSurfaceFaces } from "./protocol";
import type { SurfaceMesh } from "./decoded_surface";

const mostBytes = 64 << 20;
const cornersOfTriangle = 3; // which has as many vertices of its own at most

/// Joins the messages of an answer. Rejects with DATA_LOSS at the first one that breaks the protocol, so that no more is kept than was
/// announced. `onMessage` is called for each message.
export async function readSurface(
  responses: AsyncIterable<GetSurfaceResponse>,
  decoder: Pick<Decoder, "decodeSurface">,
  onMessage?: () => void,
): Promise<SurfaceMesh> {
  let parts: SurfaceParts | null = null;
  for await (const { update } of responses) {
    onMessage?.();
    if (update.case === "info") {
      if (parts !== null) throw badSurface("a second beginning");
      parts = new SurfaceParts(update.value);
    }
    if (update.case === "chunk") {
      if (parts === null) throw badSurface("a part before its beginning");
      parts.add(update.value);
    }
  }
  if (parts === null) throw badSurface("none");
  return parts.decode(decoder);
}

/// The file of one surface, never more than its beginning says.
class SurfaceParts {
  private readonly file: Uint8Array<ArrayBuffer>;
  private received = 0; // bytes

  constructor(private readonly info: SurfaceInfo) {
    const { vertices, triangles, bytes, creaseDegrees, origin } = info;
    if (triangles === 0n || triangles > maxSurfaceFaces || vertices > cornersOfTriangle * Number(triangles)) {
      throw badSurface(`one of ${vertices} vertices and ${triangles} triangles`);
    }
    if (bytes > mostBytes) throw badSurface(`one of ${bytes} bytes`);
    if (!(creaseDegrees >= 0 && creaseDegrees <= 180)) throw badSurface(`creases of ${creaseDegrees} degrees`);
    if (origin === undefined || ![origin.x, origin.y, origin.z].every(Number.isFinite)) {
      throw badSurface("an origin that is not finite");
    }
    this.file = new Uint8Array(Number(bytes));
  }

  add(chunk: Uint8Array): void {
    if (chunk.length > this.file.length - this.received) throw badSurface(`more than its ${this.file.length} bytes`);
    this.file.set(chunk, this.received);
    this.received += chunk.length;
  }

  decode(decoder: Pick<Decoder, "decodeSurface">): Promise<SurfaceMesh> {
    const { file, received, info } = this;
    if (received !== file.length) throw badSurface(`${received} of its ${file.length} bytes`);
    const { x, y, z } = info.origin!;
    const [vertices, triangles] = [Number(info.vertices), Number(info.triangles)];
    return decoder.decodeSurface({ file, vertices, triangles, origin: [x, y, z], creaseDegrees: info.creaseDegrees });
  }
}
