// SPDX-License-Identifier: Apache-2.0
import { fileURLToPath } from "node:url";

import { defineConfig } from "vitest/config";

const root = fileURLToPath(new URL("../..", import.meta.url));
const tests = `${root}tests/client/web/`;

export default defineConfig({
  root,
  server: { fs: { strict: false } },
  plugins: [
    {
      // The tests stand beside those of the rest, and use the packages of this folder.
      name: "packages-of-the-viewer",
      enforce: "pre",
      resolveId(source, importer) {
        if (importer?.startsWith(tests) !== true || /^[./]|^node:|^vitest$/.test(source)) return null;
        return this.resolve(source, fileURLToPath(import.meta.url), { skipSelf: true });
      },
    },
  ],
  test: { dir: `${tests}unit`, environment: "node", alias: { vitest: fileURLToPath(import.meta.resolve("vitest")) } },
});
