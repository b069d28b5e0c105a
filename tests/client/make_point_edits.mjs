// Writes point_edits.json: what deltas do to lists of points, and which of them are refused, for the clients of all languages.
//   node tests/client/make_point_edits.mjs
//
// Each case has
//   name
//   before   the list of points that the client has: [id, rung] each
//   edits    a PointEdits message in protobuf's JSON form
//   fresh    the points of the frame: [id, rung] each
//   after    the list after it; null: the client refuses the edits
// A point is at (id, 2 id, 3 id), with the rank id. Its radius is 2^(-rung / 2) times radiusMax of the edits where that is a positive
// number, else times 1.

import { writeFileSync } from "node:fs";
import { fileURLToPath } from "node:url";

const randomCases = 40;

/// A small generator: the same numbers in every run.
function generator(seed) {
  let state = seed;
  return (below) => {
    state = (Math.imul(state, 1_664_525) + 1_013_904_223) >>> 0;
    return Math.floor((state / 2 ** 32) * below);
  };
}

/// Indices as the message has them: the first one, then differences.
const steps = (indices) => indices.map((index, i) => (i === 0 ? index : index - indices[i - 1]));

/// Points `first`, `first` + 1 ... of one rung.
const points = (first, count, rung = 4) => Array.from({ length: count }, (_, i) => [first + i, rung]);

const four = points(0, 4);

/// Written by hand: [name, edits, fresh, after, before].
const accepted = [
  ["nothing changes", {}, [], four],
  ["into an empty list", { added: [0, 1] }, points(7, 2), points(7, 2), []],
  ["everything goes", { removed: [0, 1, 1, 1] }, [], []],
  ["everything is replaced", { removed: [0, 1, 1, 1], added: [0, 1] }, points(7, 2), points(7, 2)],
  ["before all", { added: [0] }, points(7, 1), [[7, 4], ...four]],
  ["behind all", { added: [4] }, points(7, 1), [...four, [7, 4]]],
  [
    "between",
    { added: [1, 2] },
    points(7, 2),
    [
      [0, 4],
      [7, 4],
      [1, 4],
      [8, 4],
      [2, 4],
      [3, 4],
    ],
  ],
  ["the first goes, another comes last", { removed: [0], added: [3] }, points(7, 1), [...points(1, 3), [7, 4]]],
  ["the last goes, another comes first", { removed: [3], added: [0] }, points(7, 1), [[7, 4], ...points(0, 3)]],
  [
    "in the place of one that goes",
    { removed: [1], added: [1] },
    points(7, 1),
    [
      [0, 4],
      [7, 4],
      [2, 4],
      [3, 4],
    ],
  ],
  [
    "one rung larger, one smaller",
    { resized: [0, 7], radiusMax: 2 },
    [],
    [
      [0, 3],
      [1, 4],
      [2, 4],
      [3, 5],
    ],
  ],
  [
    "several rungs",
    { resized: [1, 1, 1, 2, 0], radiusMax: 2 },
    [],
    [
      [0, 7],
      [1, 2],
      [2, 4],
      [3, 4],
    ],
  ],
  ["no larger than the largest", { resized: [0, 0, 0, 0, 0, 0], radiusMax: 2 }, [], [[0, 0], ...points(1, 3)]],
  [
    "no smaller than the smallest",
    { resized: [3, 1], radiusMax: 2 },
    [],
    [
      [0, 4],
      [1, 63],
    ],
    [
      [0, 4],
      [1, 62],
    ],
  ],
  [
    "a radius that is no power of two",
    { resized: [2, 2], radiusMax: 0.3 },
    [],
    [
      [0, 4],
      [1, 3],
      [2, 3],
      [3, 4],
    ],
  ],
  [
    "a point that has just come",
    { added: [2], resized: [5], radiusMax: 2 },
    points(7, 1),
    [
      [0, 4],
      [1, 4],
      [7, 5],
      [2, 4],
      [3, 4],
    ],
  ],
  [
    "by the index after others have gone",
    { removed: [0], resized: [0], radiusMax: 2 },
    [],
    [
      [1, 3],
      [2, 4],
      [3, 4],
    ],
  ],
];

/// Written by hand: [name, edits, fresh].
const refused = [
  ["removed beyond the end", { removed: [4] }, []],
  ["removed twice", { removed: [1, 0] }, []],
  ["more removed than there are", { removed: [0, 1, 1, 1, 1] }, []],
  ["removed beyond 32 bits", { removed: [1, 4_294_967_295] }, []],
  ["added beyond the end", { added: [5] }, points(7, 1)],
  ["added twice", { added: [1, 0] }, points(7, 2)],
  ["added beyond 32 bits", { added: [1, 4_294_967_295] }, points(7, 2)],
  ["points without indices", {}, points(7, 1)],
  ["fewer indices than points", { added: [0] }, points(7, 2)],
  ["more indices than points", { added: [0, 1] }, points(7, 1)],
  ["resized beyond the end", { resized: [8], radiusMax: 2 }, []],
  ["resized beyond 32 bits", { resized: [2, 4_294_967_294], radiusMax: 2 }, []],
  ["resized by the index of one that has gone", { removed: [3], resized: [6], radiusMax: 2 }, []],
  ["a largest radius of nothing", { resized: [0] }, []],
  ["a negative largest radius", { resized: [0], radiusMax: -1 }, []],
  ["a largest radius that is no number", { resized: [0], radiusMax: "NaN" }, []],
  ["a largest radius without end", { resized: [0], radiusMax: "Infinity" }, []],
];

/// A list of up to 60 points, of which some go, with up to 20 new ones, and some rungs.
function randomCase(number) {
  const random = generator(number + 1);
  const before = points(0, random(60)).map(([id]) => [id, 8 + random(8)]);
  const share = random(11);
  const removed = before.map((_, i) => i).filter(() => random(10) < share);
  const kept = before.filter((_, i) => !removed.includes(i));
  const fresh = points(1000, random(20)).map(([id]) => [id, 8 + random(8)]);
  const size = kept.length + fresh.length;
  const gaps = new Set();
  while (gaps.size < fresh.length) gaps.add(random(size));
  const added = [...gaps].sort((a, b) => a - b);
  const [oldPoints, newPoints] = [kept.values(), fresh.values()];
  const after = Array.from({ length: size }, (_, i) => [...(gaps.has(i) ? newPoints : oldPoints).next().value]);
  const resized = [];
  let last = 0;
  for (const [i, point] of after.entries()) {
    const isSmaller = random(2); // all steps of a point go the same way
    for (let times = random(6) === 0 ? 1 + random(3) : 0; times > 0; --times) {
      resized.push(2 * (i - last) + isSmaller);
      last = i;
      point[1] += isSmaller === 1 ? 1 : -1;
    }
  }
  const edits = { removed: steps(removed), added: steps(added), resized, ...(resized.length > 0 && { radiusMax: 2 }) };
  return { name: `random ${number}`, before, edits, fresh, after };
}

/// All of them.
export function pointEditsCases() {
  return [
    ...accepted.map(([name, edits, fresh, after, before = four]) => ({ name, before, edits, fresh, after })),
    ...refused.map(([name, edits, fresh]) => ({ name, before: four, edits, fresh, after: null })),
    ...Array.from({ length: randomCases }, (_, number) => randomCase(number)),
  ];
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const lines = pointEditsCases().map((each) => `  ${JSON.stringify(each)}`);
  writeFileSync(new URL("point_edits.json", import.meta.url), `[\n${lines.join(",\n")}\n]\n`);
}
