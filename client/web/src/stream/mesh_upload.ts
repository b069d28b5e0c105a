// Sends a mesh file and the files that it refers to.

import type { DescMessage } from "@bufbuild/protobuf";

import { CurvecastService, type UploadMeshResponse } from "../gen/curvecast/v1/curvecast_pb";
import type { Call } from "./call";
import { asCurvecastError, CurvecastError } from "./errors";
import type { Socket } from "./socket";

const chunkBytes = 256 << 10;
const mostCompanions = 256;
const referring = /\.(obj|gltf|glb|ply)$/i;
const companion = /\.(mtl|bin|png|jpe?g|bmp|tga|gif|webp|ktx2)$/i;

/// A file that a page was given, by its name or by a path below the mesh's folder.
export interface NamedFile {
  name: string;
  data: Blob;
}

/// What is under way, and how to stop it.
export interface UploadOptions {
  onProgress?(sent: number, total: number, name: string): void; // bytes of the file `name` that have left
  signal?: AbortSignal;
}

/// What CreateSession wants to know. `missing`: files that the mesh refers to and that are not among those given.
export interface UploadedMesh {
  meshId: string;
  companions: Record<string, string>;
  missing: string[];
}

/// Which of several files is the mesh: the first that can be one. Null where none can.
export function meshAmong(files: readonly NamedFile[]): NamedFile | null {
  return (
    files.find((file) => /\.(ply|obj|off|stl|gltf|glb)$/i.test(file.name)) ??
    files.find((file) => !companion.test(file.name)) ??
    null
  );
}

/// Sends one file, and returns its mesh_id. A long one deserves a socket of its own.
export async function uploadFile(socket: Socket, file: NamedFile, { onProgress, signal }: UploadOptions = {}): Promise<string> {
  let response: UploadMeshResponse | null = null;
  let call!: Call<DescMessage, DescMessage>;
  const cancel = () => call.cancel();
  const ended = new Promise<void>((resolve, reject) => {
    const started = socket.start(CurvecastService.method.uploadMesh, {
      onMessage: (message) => (response = message),
      onEnd: (error) => (error === null ? resolve() : reject(error)),
    });
    call = started as unknown as Call<DescMessage, DescMessage>;
    started.send({ part: { case: "header", value: { name: file.name, size: BigInt(file.data.size) } } });
  });
  ended.catch(() => {}); // told below
  signal?.addEventListener("abort", cancel, { once: true });
  try {
    if (signal?.aborted) throw new CurvecastError("CANCELLED", "cancelled");
    for (let begin = 0; begin < file.data.size && !call.ended; begin += chunkBytes) {
      const chunk = new Uint8Array(await file.data.slice(begin, begin + chunkBytes).arrayBuffer());
      call.send({ part: { case: "chunk", value: chunk } });
      await socket.drained(signal);
      onProgress?.(Math.max(0, begin + chunk.length - socket.bufferedBytes), file.data.size, file.name);
    }
    call.halfClose();
    await ended;
  } catch (thrown) {
    call.cancel();
    if (thrown instanceof DOMException && thrown.name === "NotReadableError") {
      throw new CurvecastError("INVALID_ARGUMENT", `${file.name} cannot be read`);
    }
    throw asCurvecastError(thrown);
  } finally {
    signal?.removeEventListener("abort", cancel);
  }
  const result = response as UploadMeshResponse | null;
  if (result === null) throw new CurvecastError("INTERNAL", "the upload ended without a response");
  onProgress?.(file.data.size, file.data.size, file.name);
  return result.meshId;
}

/// Sends a mesh, then those of `others` that it refers to, and those that these refer to.
export async function uploadMesh(
  socket: Socket,
  mesh: NamedFile,
  others: readonly NamedFile[],
  options: UploadOptions = {},
): Promise<UploadedMesh> {
  const uploaded: UploadedMesh = { meshId: await uploadFile(socket, mesh, options), companions: {}, missing: [] };
  if (!referring.test(mesh.name)) return uploaded;
  while (true) {
    const { missing } = await socket.unary(
      CurvecastService.method.listMeshReferences,
      { meshId: uploaded.meshId, companions: uploaded.companions },
      options.signal,
    );
    const found = missing.flatMap((name) => {
      const file = fileFor(name, others);
      return file === null ? [] : [{ name, file }];
    });
    uploaded.missing = missing.filter((name) => !found.some((other) => other.name === name));
    if (found.length === 0 || Object.keys(uploaded.companions).length + found.length > mostCompanions) return uploaded;
    for (const { name, file } of found) uploaded.companions[name] = await uploadFile(socket, file, options);
  }
}

/// A page is told no folders, or only those below what was dropped: the file's name decides.
function fileFor(reference: string, files: readonly NamedFile[]): NamedFile | null {
  if (!companion.test(reference)) return null;
  const lastOf = (path: string) => path.slice(path.lastIndexOf("/") + 1).toLowerCase();
  const exact = files.find((file) => file.name === reference || file.name.endsWith(`/${reference}`));
  return exact ?? files.find((file) => lastOf(file.name) === lastOf(reference)) ?? null;
}
