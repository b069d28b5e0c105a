import { defineConfig } from "vite";

// The pages are served from the root of the server's HTTP port, and work below any other path just as well.
export default defineConfig({
  base: "./",
  build: {
    target: "es2022",
    sourcemap: false,
    modulePreload: { polyfill: false }, // every browser with WebGL 2 has it
    chunkSizeWarningLimit: 1500,
    rollupOptions: { input: { viewer: "index.html", example: "example.html" } },
  },
  worker: { format: "es" },
  // `npm run dev` beside `curvecast serve`.
  server: { proxy: { "/v1/socket": { target: "ws://127.0.0.1:8080", ws: true } } },
});
