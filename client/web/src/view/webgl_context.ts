// SPDX-License-Identifier: Apache-2.0
// The canvas's context.

import { NoWebGL2Error } from "./types";

/// Opens the context of a canvas. `isSoftware`: the processor draws, for want of a graphics card. Throws NoWebGL2Error.
export function openContext(canvas: HTMLCanvasElement): { context: WebGL2RenderingContext; isSoftware: boolean } {
  const context = canvas.getContext("webgl2", {
    antialias: false,
    alpha: false,
    depth: true,
    powerPreference: "high-performance",
  });
  if (!context) throw new NoWebGL2Error();
  const info = context.getExtension("WEBGL_debug_renderer_info");
  const name = String(context.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : context.RENDERER));
  return { context, isSoftware: /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name) };
}
