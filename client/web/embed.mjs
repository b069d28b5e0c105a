// SPDX-License-Identifier: Apache-2.0
// Writes a C++ source that holds the files of a folder, compressed: node embed.mjs FOLDER SOURCE
import { createHash } from "node:crypto";
import { mkdirSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { dirname, extname, join, relative, resolve } from "node:path";
import { gzipSync } from "node:zlib";

const types = {
  ".css": "text/css; charset=utf-8",
  ".html": "text/html; charset=utf-8",
  ".js": "text/javascript; charset=utf-8",
  ".json": "application/json",
  ".png": "image/png",
  ".svg": "image/svg+xml",
  ".wasm": "application/wasm",
};

/// The hashes of the scripts that stand in a page itself, as a policy allows them.
function scriptsWithin(file, bytes) {
  if (extname(file) !== ".html") return "";
  const scripts = [...bytes.toString().matchAll(/<script(?![^>]* src=)[^>]*>([^]*?)<\/script>/g)];
  return scripts.map(([, script]) => `'sha256-${createHash("sha256").update(script).digest("base64")}'`).join(" ");
}

const [folder, source] = process.argv.slice(2);
const files = readdirSync(folder, { recursive: true, withFileTypes: true })
  .filter((entry) => entry.isFile())
  .map((entry) => relative(folder, join(entry.parentPath ?? entry.path, entry.name)))
  .sort();
const packed = resolve(dirname(source), "packed");
mkdirSync(packed, { recursive: true });

const assembly = [];
const declarations = [];
const rows = [];
files.forEach((file, i) => {
  const type = types[extname(file)];
  if (type === undefined) throw new Error(`embed: there is no type for ${file}`);
  const at = join(packed, `${i}.gz`);
  const bytes = readFileSync(join(folder, file));
  writeFileSync(at, gzipSync(bytes, { level: 9 }));
  assembly.push(
    `    ".balign 16\\ncurvecast_file_${i}:\\n.incbin ${JSON.stringify(at).replaceAll('"', '\\"')}\\ncurvecast_file_${i}_end:\\n"`,
  );
  declarations.push(`extern const char curvecast_file_${i}[], curvecast_file_${i}_end[];`);
  const isImmutable = file.startsWith("assets/"); // Vite puts hashes into these names
  rows.push(
    `      {${JSON.stringify("/" + file)}, ${JSON.stringify(type)}, bytes(curvecast_file_${i}, curvecast_file_${i}_end), ${isImmutable}, ${JSON.stringify(scriptsWithin(file, bytes))}},`,
  );
});
writeFileSync(
  source,
  `// Made by embed.mjs.
#include "client/web/viewer_files.h"

#include <array>
#include <cstddef>

asm(".pushsection .rodata\\n"
${assembly.join("\n")}
    ".popsection\\n");
extern "C" {
${declarations.join("\n")}
}

namespace curvecast::web {
namespace {

std::string_view bytes(const char* begin, const char* end) { return {begin, static_cast<std::size_t>(end - begin)}; }

}  // namespace

std::span<const server::WebFile> viewer_files() {
  static const std::array<server::WebFile, ${files.length}> files = {{
${rows.join("\n")}
  }};
  return files;
}

}  // namespace curvecast::web
`,
);
