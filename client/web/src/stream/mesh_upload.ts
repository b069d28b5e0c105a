// SPDX-License-Identifier: Apache-2.0
// Uploads a mesh file and the files that it refers to.

import { CurvecastService, type UploadMeshResponse } from "../gen/curvecast/v1/curvecast_pb";
import { asCurvecastError, CurvecastError } from "./errors";
import { maxCompanions } from "./protocol";
import { repeat } from "./repeat";
import type { Socket } from "./socket";

const chunkBytes = 256 << 10;
const maxRestarts = 4; // of a file's minute of failures (see repeat()): a line that breaks again and again may be too slow for the file
const referring = /\.(obj|gltf|glb|ply)$/i;
const companion = /\.(mtl|bin|png|jpe?g|bmp|tga|gif|webp|ktx2)$/i;

/// A file of the user. `name`: its name, or its path below the mesh's folder.
export interface NamedFile {
  name: string;
  data: Blob;
}

/// How to follow an upload, and how to stop it.
export interface UploadOptions {
  /// `sent` of `total` bytes of the file `name` have left. Begins again from 0 where the connection was lost.
  onProgress?(sent: number, total: number, name: string): void;
  signal?: AbortSignal;
}

/// A mesh that the server has, as createSession() wants it. `missing`: files that the mesh refers to and that were not given.
export interface UploadedMesh {
  meshId: string;
  companions: Record<string, string>;
  missing: string[];
}

/// Finds the mesh among several files: the first that can be one. Returns null where none can.
export function meshAmong(files: readonly NamedFile[]): NamedFile | null {
  return (
    files.find((file) => /\.(ply|obj|off|stl|gltf|glb|3mf)$/i.test(file.name)) ??
    files.find((file) => !companion.test(file.name)) ??
    null
  );
}

/// Uploads one file, and returns its mesh_id. A long file deserves a socket of its own. Where the socket is lost, the file is sent from
/// its start over the next one: only a client that knows the file's hash could resume what the server has kept. `connect` returns a
/// socket that is open or opening: a new one after the last was lost.
export async function uploadFile(connect: () => Socket, file: NamedFile, options: UploadOptions = {}): Promise<string> {
  if (file.data.size === 0) throw new CurvecastError("INVALID_ARGUMENT", `the file ${file.name} is empty`);
  let restarts = 0;
  return repeat((resetFailures) => {
    let hasLeft = false;
    const onLeft = () => {
      if (hasLeft) return;
      hasLeft = true;
      if (++restarts <= maxRestarts) resetFailures();
    };
    return sendFile(connect(), file, onLeft, options);
  }, options.signal);
}

/// Sends one file over one socket. `onLeft` is called whenever some of the file has left.
async function sendFile(socket: Socket, file: NamedFile, onLeft: () => void, options: UploadOptions): Promise<string> {
  const { signal } = options;
  let response: UploadMeshResponse | null = null;
  let onEnd!: (error: CurvecastError | null) => void;
  const ended = new Promise<void>((resolve, reject) => (onEnd = (error) => (error === null ? resolve() : reject(error))));
  ended.catch(() => {}); // awaited below
  const call = socket.start(CurvecastService.method.uploadMesh, { onMessage: (message) => (response = message), onEnd });
  const cancel = () => call.cancel();
  signal?.addEventListener("abort", cancel, { once: true });
  if (signal?.aborted) cancel();
  try {
    call.send({ part: { case: "header", value: { name: file.name, size: BigInt(file.data.size) } } });
    for (let begin = 0; begin < file.data.size && !call.ended; begin += chunkBytes) {
      const chunk = new Uint8Array(await file.data.slice(begin, begin + chunkBytes).arrayBuffer());
      call.send({ part: { case: "chunk", value: chunk } });
      await socket.drained(signal);
      const left = Math.max(0, begin + chunk.length - socket.bufferedBytes);
      if (left > 0) onLeft();
      options.onProgress?.(left, file.data.size, file.name);
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
  options.onProgress?.(file.data.size, file.data.size, file.name);
  return result.meshId;
}

/// Uploads a mesh, then the files among `others` that it refers to, and those that these refer to. Empty ones count as missing. `connect` as
/// for uploadFile().
export async function uploadMesh(
  connect: () => Socket,
  mesh: NamedFile,
  others: readonly NamedFile[],
  options: UploadOptions = {},
): Promise<UploadedMesh> {
  const uploaded: UploadedMesh = { meshId: await uploadFile(connect, mesh, options), companions: {}, missing: [] };
  if (!referring.test(mesh.name)) return uploaded;
  const filled = others.filter(({ data }) => data.size > 0);
  while (true) {
    const { meshId, companions } = uploaded;
    const { listMeshReferences } = CurvecastService.method;
    const { missing } = await repeat(
      () => connect().unary(listMeshReferences, { meshId, companions }, options.signal),
      options.signal,
    );
    const unknown = missing.filter((name) => !Object.hasOwn(companions, name)); // a server that repeats a name does not keep the loop going
    const found = unknown.flatMap((name) => {
      const file = fileFor(name, filled);
      return file === null ? [] : [{ name, file }];
    });
    uploaded.missing = missing.filter((name) => !found.some((other) => other.name === name));
    if (found.length === 0 || Object.keys(uploaded.companions).length + found.length > maxCompanions) return uploaded;
    for (const { name, file } of found) uploaded.companions[name] = await uploadFile(connect, file, options);
  }
}

/// Finds the file for a reference. Browsers give a page no folders, or only those below a dropped one, so that a file's name suffices.
function fileFor(reference: string, files: readonly NamedFile[]): NamedFile | null {
  if (!companion.test(reference)) return null;
  const lastOf = (path: string) => path.slice(path.lastIndexOf("/") + 1).toLowerCase();
  const exact = files.find((file) => file.name === reference || file.name.endsWith(`/${reference}`));
  return exact ?? files.find((file) => lastOf(file.name) === lastOf(reference)) ?? null;
}
