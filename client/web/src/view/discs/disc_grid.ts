// SPDX-License-Identifier: Apache-2.0
// Discs in the cells of a grid, to find those that touch each other. Each octave of radii has a grid of its own, so that
// cells hold a handful of discs of any size.

const maxRadius = 1e30; // beyond, products of lengths are infinite
/// Numbers of a disc in `discs`: position, radius, unit normal, and one that is not used.
export const stride = 8;

/// Discs with a radius and a normal, numbered cell by cell.
export interface DiscGrid {
  readonly count: number;
  readonly discs: Float32Array;
  /// The slot of each disc.
  readonly slots: Uint32Array;
  readonly cells: Cells;
}

/// Cells that hold discs. Their discs are those from begin[i] to begin[i + 1].
export interface Cells {
  count: number;
  begin: Uint32Array;
  level: Uint8Array; // exponent of the radii
  place: Int32Array; // 3 a cell: in the grid of its level
  /// Hash table of the cells: number + 1, or 0.
  table: Uint32Array;
  /// Levels that have cells: 1.
  levels: Uint8Array;
}

/// Cells in a unit of length, for each level. Discs have a diameter of a cell's edge at most.
const perUnit = Float64Array.from({ length: 256 }, (_, level) => 2 ** (127 - 2 - level));

const hashOf = (x: number, y: number, z: number, level: number): number => {
  const h = Math.imul(x, 0x9e3779b1) ^ Math.imul(y, 0x85ebca6b) ^ Math.imul(z, 0xc2b2ae35) ^ Math.imul(level, 0x27d4eb2f);
  return Math.imul(h ^ (h >>> 15), 0x2c1b3c6d) >>> 7;
};

/// Returns the cell at a place, and -1 where there is none.
function cellAt(cells: Cells, x: number, y: number, z: number, level: number): number {
  const { table } = cells;
  const mask = table.length - 1;
  for (let at = hashOf(x, y, z, level) & mask; ; at = (at + 1) & mask) {
    const cell = table[at]! - 1;
    if (cell < 0) return -1;
    if (isAt(cells, cell, x, y, z, level)) return cell;
  }
}

function isAt({ place, level: levels }: Cells, cell: number, x: number, y: number, z: number, level: number): boolean {
  return place[3 * cell] === x && place[3 * cell + 1] === y && place[3 * cell + 2] === z && levels[cell] === level;
}

/// Sorts the discs of `slots` slots, whose columns are those of a PointStore, into cells. Radii are multiplied by `scale`.
export function makeGrid(positions: Float32Array, normals: Int8Array, slots: number, scale: number): DiscGrid {
  const cellOf = new Int32Array(slots);
  const cells = makeCells(slots);
  const exponent = new Float32Array(1);
  const bits = new Uint32Array(exponent.buffer);
  const mask = cells.table.length - 1;
  let count = 0;
  let cell = 0; // neighbours in the order of the slots mostly share one
  for (let slot = 0, at = 0; slot < slots; ++slot, at += 4) {
    cellOf[slot] = -1;
    const radius = positions[at + 3]! * scale;
    if (!(radius > 0 && radius < maxRadius)) continue;
    if (!Number.isFinite(positions[at]! + positions[at + 1]! + positions[at + 2]!)) continue;
    if (normals[at] === 0 && normals[at + 1] === 0 && normals[at + 2] === 0) continue;
    exponent[0] = radius;
    const level = bits[0]! >>> 23;
    const x = Math.floor(positions[at]! * perUnit[level]!) | 0;
    const y = Math.floor(positions[at + 1]! * perUnit[level]!) | 0;
    const z = Math.floor(positions[at + 2]! * perUnit[level]!) | 0;
    if (!isAt(cells, cell, x, y, z, level)) cell = cellAt(cells, x, y, z, level);
    if (cell < 0) {
      cell = cells.count++;
      cells.place[3 * cell] = x;
      cells.place[3 * cell + 1] = y;
      cells.place[3 * cell + 2] = z;
      cells.level[cell] = level;
      cells.levels[level] = 1;
      let free = hashOf(x, y, z, level) & mask;
      while (cells.table[free] !== 0) free = (free + 1) & mask;
      cells.table[free] = cell + 1;
    }
    cellOf[slot] = cell;
    ++cells.begin[cell + 1]!;
    ++count;
  }
  for (let cell = 0; cell < cells.count; ++cell) cells.begin[cell + 1]! += cells.begin[cell]!;
  return { count, cells, ...sorted(positions, normals, scale, cellOf, cells, count) };
}

function makeCells(most: number): Cells {
  return {
    count: 0,
    begin: new Uint32Array(most + 1),
    level: new Uint8Array(most),
    place: new Int32Array(3 * most),
    table: new Uint32Array(2 ** Math.ceil(Math.log2(2 * most + 2))),
    levels: new Uint8Array(256),
  };
}

function sorted(
  positions: Float32Array,
  normals: Int8Array,
  scale: number,
  cellOf: Int32Array,
  cells: Cells,
  count: number,
): Pick<DiscGrid, "discs" | "slots"> {
  const discs = new Float32Array(stride * count);
  const slots = new Uint32Array(count);
  const next = cells.begin.slice(0, cells.count);
  for (let slot = 0, at = 0; slot < cellOf.length; ++slot, at += 4) {
    const cell = cellOf[slot]!;
    if (cell < 0) continue;
    const disc = next[cell]!++;
    const to = stride * disc;
    const [x, y, z] = [normals[at]!, normals[at + 1]!, normals[at + 2]!];
    const size = Math.sqrt(x * x + y * y + z * z);
    discs[to] = positions[at]!;
    discs[to + 1] = positions[at + 1]!;
    discs[to + 2] = positions[at + 2]!;
    discs[to + 3] = positions[at + 3]! * scale;
    discs[to + 4] = x / size;
    discs[to + 5] = y / size;
    discs[to + 6] = z / size;
    slots[disc] = slot;
  }
  return { discs, slots };
}

/// Calls `visit` for the pairs of cells that may hold discs that touch, those of a cell with itself among them, each once.
export function forEachPair({ cells }: DiscGrid, visit: (a: number, b: number) => void): void {
  const levels = [...cells.levels.keys()].filter((level) => cells.levels[level] === 1);
  for (let cell = 0; cell < cells.count; ++cell) {
    const level = cells.level[cell]!;
    const x = cells.place[3 * cell]!;
    const y = cells.place[3 * cell + 1]!;
    const z = cells.place[3 * cell + 2]!;
    for (let i = 13; i < 27; ++i) {
      // Half of those around it: the others have this one among theirs.
      const other = cellAt(cells, x + (i % 3) - 1, y + ((Math.floor(i / 3) % 3) - 1), z + (Math.floor(i / 9) - 1), level);
      if (other >= 0) visit(cell, other);
    }
    for (const larger of levels) if (larger > level) forEachLarger(cells, cell, larger, visit);
  }
}

/// Calls `visit` for the pairs of a cell with those of a level of larger discs.
function forEachLarger(cells: Cells, cell: number, level: number, visit: (a: number, b: number) => void): void {
  const share = 2 ** (cells.level[cell]! - level); // of the larger edge
  const reach = 0.5 * (share + 1); // of two discs, in larger edges
  const x = cells.place[3 * cell]! * share;
  const y = cells.place[3 * cell + 1]! * share;
  const z = cells.place[3 * cell + 2]! * share;
  const endX = x + share + reach;
  const endY = y + share + reach;
  const endZ = z + share + reach;
  for (let k = Math.floor(z - reach); k < endZ; ++k) {
    for (let j = Math.floor(y - reach); j < endY; ++j) {
      for (let i = Math.floor(x - reach); i < endX; ++i) {
        const other = cellAt(cells, i, j, k, level);
        if (other >= 0) visit(cell, other);
      }
    }
  }
}
