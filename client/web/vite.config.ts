// SPDX-License-Identifier: Apache-2.0
import { defineConfig, type Plugin } from "vite";

/// Puts the page's first script into the page itself, so that it waits for nothing, and has it load the others: a browser would ask for
/// these first. embed.mjs has the server allow it.
const firstScript: Plugin = {
  name: "first-script",
  transformIndexHtml: {
    order: "post",
    handler(html, { bundle, chunk, filename }) {
      const first = Object.values(bundle ?? {}).find((file) => file.type === "chunk" && file.name === "first");
      if (first?.type !== "chunk" || chunk === undefined || !filename.endsWith("index.html")) return html;
      const others = [chunk.fileName, ...chunk.imports].map((file) => `import("./${file}");`).join("");
      return {
        html: html.replace(/ *<(script type="module"[^>]*><\/script|link rel="modulepreload"[^>]*)>\n/g, ""),
        tags: [{ tag: "script", attrs: { type: "module", async: true }, children: first.code + others, injectTo: "body" }],
      };
    },
  },
};

// The pages are served from the root of the server's HTTP port, and work below any other path just as well.
export default defineConfig({
  base: "./",
  plugins: [firstScript],
  build: {
    target: "es2022",
    sourcemap: false,
    modulePreload: { polyfill: false }, // every browser with WebGL 2 has it
    chunkSizeWarningLimit: 1500,
    rollupOptions: { input: { first: "src/app/first.ts", viewer: "index.html", example: "example.html" } },
  },
  worker: { format: "es" },
  // `npm run dev` beside `curvecast serve`.
  server: { proxy: { "/v1/socket": { target: "ws://127.0.0.1:8080", ws: true } } },
});
