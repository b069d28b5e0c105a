// SPDX-License-Identifier: Apache-2.0
// The WebAssembly of draco3d, from the page's own server. In the package for other pages, package/inlined_wasm.ts is in its place.

import wasmUrl from "draco3d/draco_decoder.wasm?url";

import { CurvecastError } from "../errors";

/// Loads it. Rejects with UNAVAILABLE.
export async function loadWasm(): Promise<ArrayBuffer> {
  const response = await fetch(wasmUrl);
  if (!response.ok) throw new CurvecastError("UNAVAILABLE", `the decoder cannot be loaded: HTTP status ${response.status}`);
  return response.arrayBuffer();
}
