// SPDX-License-Identifier: Apache-2.0
// The WebAssembly of draco3d within the file itself: in the place of src/stream/draco/wasm.ts.

import packed from "draco3d/draco_decoder.wasm?gzip";

/// Unpacks it, when it is first needed.
export async function loadWasm(): Promise<ArrayBuffer> {
  const bytes = Uint8Array.from(atob(packed), (character) => character.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
}
