// SPDX-License-Identifier: Apache-2.0
// Builds the npm package into a folder: node package/build.mjs FOLDER VERSION
import { copyFileSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

import { build } from "vite";

import { writeDeclarations } from "./declarations.mjs";
import { gzippedFiles, inlinedWorkers, licencesOf, notedPackages, replaced } from "./plugins.mjs";

const [folder, version] = process.argv.slice(2);
if (version === undefined) throw new Error("usage: node package/build.mjs FOLDER VERSION");
const here = dirname(fileURLToPath(import.meta.url));
const root = dirname(here);
const target = resolve(folder);
rmSync(target, { recursive: true, force: true });
mkdirSync(target, { recursive: true });

/// What is in dist/, and which packages stay outside of it.
const entries = [
  { name: "curvecast", source: join(root, "src/stream/index.ts"), external: [] },
  { name: "three", source: join(here, "three.ts"), external: ["three"] },
  { name: "element", source: join(root, "src/element/index.ts"), external: [] },
];

const packages = new Map();
const plugins = () => [
  inlinedWorkers,
  gzippedFiles,
  replaced("/stream/draco/wasm", join(here, "inlined_wasm.ts")),
  notedPackages(packages),
];
for (const { name, source, external } of entries) {
  await build({
    root,
    configFile: false,
    logLevel: "error",
    plugins: plugins(),
    worker: { format: "iife", plugins, rollupOptions: { output: { inlineDynamicImports: true } } },
    build: {
      target: "es2022",
      outDir: join(target, "dist"),
      emptyOutDir: false,
      copyPublicDir: false,
      modulePreload: false,
      chunkSizeWarningLimit: 2000,
      rollupOptions: {
        input: source,
        external,
        preserveEntrySignatures: "strict",
        output: { format: "es", entryFileNames: `${name}.js`, inlineDynamicImports: true },
      },
    },
  });
}
writeDeclarations(
  entries.map(({ source }) => source),
  root,
  join(root, "tsconfig.json"),
  join(target, "dist/types"),
);

const { dependencies } = JSON.parse(readFileSync(join(root, "package.json"), "utf8"));
const manifest = JSON.parse(readFileSync(join(here, "package.json"), "utf8"));
delete manifest.private;
manifest.version = version;
manifest.dependencies = { "@bufbuild/protobuf": `^${dependencies["@bufbuild/protobuf"]}` }; // its types are part of ours
writeFileSync(join(target, "package.json"), `${JSON.stringify(manifest, null, 2)}\n`);
writeFileSync(join(target, "THIRD_PARTY_LICENSES"), licencesOf(packages));
copyFileSync(join(here, "README.md"), join(target, "README.md"));
copyFileSync(join(root, "LICENSE"), join(target, "LICENSE"));
