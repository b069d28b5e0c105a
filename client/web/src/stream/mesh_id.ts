// SPDX-License-Identifier: Apache-2.0
// The id of a mesh file, computed where the file is.

const maxBytes = 64 << 20; // WebCrypto takes a file as a whole
const idBytes = 16; // of SHA-256

/// Computes the mesh_id that a server gives to a file. Empty where it is not to be had here: of a large file, of one that cannot be
/// read, and in pages that came neither from this machine nor by https, which have no WebCrypto.
export async function meshIdOf(file: Blob): Promise<string> {
  const subtle = (globalThis as { crypto?: { subtle?: SubtleCrypto } }).crypto?.subtle;
  if (subtle === undefined || file.size > maxBytes) return "";
  try {
    const digest = new Uint8Array(await subtle.digest("SHA-256", await file.arrayBuffer()));
    return Array.from(digest.subarray(0, idBytes), (byte) => byte.toString(16).padStart(2, "0")).join("");
  } catch {
    return ""; // who sends the file hears why
  }
}
