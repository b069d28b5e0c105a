// The table of programs that read files of points, made by the tests while they run: a line of text for each thing that was compared,
// with tabs between format, program, what was compared, and what came of it. `node reader_table.mjs FILE` prints it.

import { appendFileSync, readFileSync } from "node:fs";
import { fileURLToPath } from "node:url";

const HEAD = ["format", "program", "what was compared", "result"];
const FAILED = "FAILED";

/**
 * Runs a comparison, which returns in a few words what it found, and adds it to the file that CURVECAST_READER_TABLE names, where it
 * is set. A comparison that throws is added as failed, and throws.
 */
export async function compared(format, program, what, compare) {
  let result = FAILED;
  try {
    result = await compare();
  } finally {
    const table = process.env.CURVECAST_READER_TABLE;
    if (table) appendFileSync(table, `${[format, program, what, result].join("\t")}\n`);
  }
}

/** Says how far, in units of the mesh, places are from where they should be. */
export const within = (distance) => (distance === 0 ? "equal" : `within ${distance.toExponential(1)}`);

/** The lines of a table with aligned columns. Results of the same comparison stand in one line. */
function lines(text) {
  const rows = new Map();
  for (const line of text.split("\n").filter(Boolean)) {
    const cells = line.split("\t");
    const key = cells.slice(0, 3).join("\t");
    rows.set(key, [...(rows.get(key) ?? []), cells[3]]);
  }
  const joined = (results) => (results.includes(FAILED) ? FAILED : [...new Set(results)].join("; "));
  const table = [HEAD, ...[...rows].map(([key, results]) => [...key.split("\t"), joined(results)])];
  const widths = HEAD.map((_, k) => Math.max(...table.map((cells) => cells[k].length)));
  return table.map((cells) =>
    cells
      .map((cell, k) => cell.padEnd(widths[k]))
      .join("  ")
      .trimEnd(),
  );
}

if (process.argv[1] === fileURLToPath(import.meta.url)) console.log(lines(readFileSync(process.argv[2], "utf8")).join("\n"));
