// SPDX-License-Identifier: Apache-2.0
// What makes one file of an entry: workers and WebAssembly are texts in it, so that it works from any server.
import { readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import { gzipSync } from "node:zlib";

/// Workers that are made as in `new Worker(new URL("./x.ts", import.meta.url), { type: "module", name: "x" })`.
export const inlinedWorkers = {
  name: "inlined-workers",
  enforce: "pre",
  transform(code, id) {
    if (!code.includes("new Worker(")) return null;
    const imports = [];
    const changed = code.replace(
      /new Worker\(new URL\("([^"]+)", import\.meta\.url\), \{ type: "module", name: ("[^"]+") \}\)/g,
      (_, file, name) => {
        imports.push(`import InlinedWorker${imports.length} from "${file}?worker&inline";`);
        return `new InlinedWorker${imports.length - 1}({ name: ${name} })`;
      },
    );
    if (changed.includes("new Worker(")) this.error(`${id}: a worker that is made in another way cannot be put into the file`);
    return { code: `${imports.join("")}${changed}`, map: null };
  },
};

/// `import text from "FILE?gzip"`: a file, compressed, as base64.
export const gzippedFiles = {
  name: "gzipped-files",
  enforce: "pre",
  async resolveId(source, importer) {
    if (!source.endsWith("?gzip")) return null;
    const found = await this.resolve(source.slice(0, -"?gzip".length), importer, { skipSelf: true });
    return found && `${found.id}?gzip`;
  },
  load(id) {
    if (!id.endsWith("?gzip")) return null;
    const packed = gzipSync(readFileSync(id.slice(0, -"?gzip".length)), { level: 9 });
    return `export default ${JSON.stringify(packed.toString("base64"))};`;
  },
};

/// Has `from` (the end of a path without its .ts) be another file wherever it is imported.
export const replaced = (from, to) => ({
  name: "replaced",
  enforce: "pre",
  async resolveId(source, importer) {
    if (!source.startsWith(".") || importer === undefined) return null;
    return join(importer, "..", source).endsWith(from) ? to : null;
  },
});

/// Notes in `packages` which modules are part of what is built: by the name of a package its folder and files.
export const notedPackages = (packages) => ({
  name: "noted-packages",
  generateBundle(_, bundle) {
    for (const chunk of Object.values(bundle)) {
      for (const id of Object.keys(chunk.modules ?? {})) {
        const [file, folder, name] = /^\0?(\/.*\/node_modules\/((?:@[^/]+\/)?[^/]+))\/[^?]*/.exec(id) ?? [];
        if (name === undefined) continue;
        if (!packages.has(name)) packages.set(name, { folder, files: new Set() });
        packages.get(name).files.add(file.replace("\0", ""));
      }
    }
  },
});

/// What files say at their beginning of who has the rights to them, once each.
function noticesIn(files) {
  const found = new Set();
  for (const file of files) {
    const [head = ""] = /^(?:\/\/.*\n)+/.exec(readFileSync(file, "utf8")) ?? [];
    if (/copyright/i.test(head)) found.add(head.replace(/^\/\/ ?/gm, ""));
  }
  return [...found].sort();
}

/// The licences of noted packages, one after the other.
export function licencesOf(packages) {
  const parts = [...packages]
    .sort(([a], [b]) => (a < b ? -1 : 1))
    .map(([name, { folder, files }]) => {
      const { version, license, author } = JSON.parse(readFileSync(join(folder, "package.json"), "utf8"));
      const file = readdirSync(folder).find((each) => /^licen[cs]e/i.test(each));
      if (file !== undefined) return `${name} ${version}\n\n${readFileSync(join(folder, file), "utf8").trim()}\n`;
      if (!license.includes("Apache-2.0")) throw new Error(`${name}: there is no text of its licence, ${license}`);
      const by = author === undefined ? "" : `, by ${author.name ?? author}`;
      return [`${name} ${version}${by}: ${license}. LICENSE has the Apache License.\n`, ...noticesIn(files)].join("\n");
    });
  return `The files in dist/ hold parts of these packages.\n\n${parts.join(`\n${"-".repeat(72)}\n\n`)}`;
}
