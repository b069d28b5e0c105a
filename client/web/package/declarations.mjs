// SPDX-License-Identifier: Apache-2.0
// Writes the .d.ts files of entries, and of what these refer to.
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { dirname, join, relative } from "node:path";

import ts from "typescript";

/// Turns lines that begin with /// into comments that tsc keeps and editors show.
export function documented(text) {
  return text.replace(/^([ \t]*)\/\/\/ (?!<)[^]*?(?=\n(?![ \t]*\/\/\/))/gm, (comment, indent) => {
    const lines = comment.split("\n").map((line) => line.trim().slice("/// ".length).replaceAll("*/", "* /"));
    return `${indent}/** ${lines.join(`\n${indent} * `)} */`;
  });
}

/// Has relative imports name files, as Node wants them: "./a" becomes "./a.js" or "./a/index.js".
function withExtensions(file, text, files) {
  return text.replace(/((?:from|import)\s*\(?\s*")(\.[^"]+)(")/g, (_, before, to, after) => {
    const target = join(dirname(file), to);
    const found = [`${target}.d.ts`, join(target, "index.d.ts")].find((each) => files.has(each));
    if (found === undefined) throw new Error(`${file}: ${to} is not there`);
    const path = relative(dirname(file), found).replace(/\.d\.ts$/, ".js");
    return before + (path.startsWith(".") ? path : `./${path}`) + after;
  });
}

/// Writes them into a folder, as below `root`. `entries` are sources, `config` is the file of tsc's options.
export function writeDeclarations(entries, root, config, folder) {
  const { options } = ts.parseJsonConfigFileContent(ts.readConfigFile(config, ts.sys.readFile).config, ts.sys, dirname(config));
  Object.assign(options, {
    noEmit: false,
    declaration: true,
    emitDeclarationOnly: true,
    rootDir: root,
    outDir: "/",
    stripInternal: true,
  });
  const host = ts.createCompilerHost(options);
  host.readFile = (path) =>
    path.startsWith(root) && !path.includes("/node_modules/") ? documented(readFileSync(path, "utf8")) : ts.sys.readFile(path);
  const files = new Map();
  host.writeFile = (path, text) => void files.set(path, text);
  const ambient = join(root, "src/stream/draco/draco3d.d.ts");
  const program = ts.createProgram([...entries, ambient, join(root, "package/gzip.d.ts")], options, host);
  const problems = [...ts.getPreEmitDiagnostics(program), ...program.emit().diagnostics];
  if (problems.length > 0) throw new Error(ts.formatDiagnostics(problems, { ...host, getNewLine: () => "\n" }));

  const waiting = entries.map((entry) => `/${relative(root, entry).replace(/\.ts$/, ".d.ts")}`);
  const written = new Set();
  for (let file = waiting.pop(); file !== undefined; file = waiting.pop()) {
    if (written.has(file)) continue;
    written.add(file);
    const text = withExtensions(file, files.get(file), files);
    for (const [, to] of text.matchAll(/(?:from|import)\s*\(?\s*"(\.[^"]+)\.js"/g)) waiting.push(`${join(dirname(file), to)}.d.ts`);
    mkdirSync(join(folder, dirname(file)), { recursive: true });
    writeFileSync(join(folder, file), text);
  }
}
