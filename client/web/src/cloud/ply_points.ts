// SPDX-License-Identifier: Apache-2.0
// The points of a PLY file.

import { FileCursor, bytesAt, blocksOf, recordsOf, type OnRead } from "./file_bytes";
import { LineFaults } from "./line_faults";
import { NumberLines } from "./number_lines";
import {
  headerBytes,
  parsePlyHeader,
  plySizes,
  type PlyElement,
  type PlyHeader,
  type PlyProperty,
  type PlyType,
} from "./ply_header";
import { bytesOf, columnsOf, PointSink, type RawPoints } from "./raw_points";
import { badFile, countText, pointsText } from "./words";

type Reader = (view: DataView, at: number) => number;

/// Which properties a vertex has of those that are needed: their numbers among its properties.
interface Layout {
  place: readonly number[];
  extras: readonly number[]; // normals first, then colours
  hasNormals: boolean;
  hasColours: boolean;
  colourScale: number; // of white; 0: 1 or 255, as the values say
}

const whites: Partial<Record<PlyType, number>> = { uint8: 255, uint16: 65_535 };

function layoutOf({ properties }: PlyElement): Layout {
  const numbersOf = (...names: string[]): number[] =>
    names.map((name) => properties.findIndex((property) => property.name === name && property.countType === null));
  const isWhole = (numbers: number[]): boolean => numbers.every((number) => number >= 0);
  const place = numbersOf("x", "y", "z");
  if (!isWhole(place)) throw badFile("its vertices have no x, y and z");
  const normals = numbersOf("nx", "ny", "nz");
  const named = [
    numbersOf("red", "green", "blue"),
    numbersOf("diffuse_red", "diffuse_green", "diffuse_blue"),
    numbersOf("r", "g", "b"),
  ];
  const colours = named.find(isWhole);
  return {
    place,
    extras: [...(isWhole(normals) ? normals : []), ...(colours ?? [])],
    hasNormals: isWhole(normals),
    hasColours: colours !== undefined,
    colourScale: colours === undefined ? 0 : (whites[properties[colours[0]!]!.type] ?? 0),
  };
}

/// Makes the function that reads a number of a type.
function readerOf(type: PlyType, isLittle: boolean): Reader {
  switch (type) {
    case "int8":
      return (view, at) => view.getInt8(at);
    case "uint8":
      return (view, at) => view.getUint8(at);
    case "int16":
      return (view, at) => view.getInt16(at, isLittle);
    case "uint16":
      return (view, at) => view.getUint16(at, isLittle);
    case "int32":
      return (view, at) => view.getInt32(at, isLittle);
    case "uint32":
      return (view, at) => view.getUint32(at, isLittle);
    case "float32":
      return (view, at) => view.getFloat32(at, isLittle);
    case "float64":
      return (view, at) => view.getFloat64(at, isLittle);
  }
}

/// Bytes of a row; null where it has lists.
const rowBytes = ({ properties }: PlyElement): number | null =>
  properties.some(({ countType }) => countType !== null) ? null : properties.reduce((sum, { type }) => sum + plySizes[type], 0);

const endsBefore = (): Error => badFile("the file ends before its points begin");

/// Reads the vertices of a file. Those after which it breaks off are kept, and a notice tells of the rest. Throws INVALID_ARGUMENT where
/// there is none to be read.
export async function readPlyPoints(file: Blob, onRead: OnRead, most?: number): Promise<RawPoints> {
  const header = parsePlyHeader(await bytesAt(file, 0, headerBytes));
  const vertices = header.elements.find(({ name }) => name === "vertex");
  if (vertices === undefined) throw badFile('it has no element "vertex"');
  const layout = layoutOf(vertices);
  const before = header.elements.slice(0, header.elements.indexOf(vertices));
  const sink = new PointSink(layout.extras.length, most);
  const notices: string[] = [];
  if (header.format === "ascii") notices.push(...(await readText(file, header, vertices, before, layout, sink, onRead)));
  else await readBinary(file, header, vertices, before, layout, sink, onRead);
  if (sink.seen === 0 && vertices.count > 0) throw badFile(`the file ends before the first of its ${pointsText(vertices.count)}`);
  if (sink.seen < vertices.count && notices.length === 0)
    notices.push(`The file ends after ${countText(sink.seen)} of ${pointsText(vertices.count)}`);
  return pointsOf(layout, sink, notices);
}

function pointsOf({ hasNormals, hasColours, colourScale }: Layout, sink: PointSink, notices: string[]): RawPoints {
  let colours: Uint8Array | null = null;
  if (hasColours) {
    const values = columnsOf(sink, hasNormals ? 3 : 0, 3);
    colours = bytesOf(values, colourScale > 0 ? colourScale : values.some((value) => value > 1) ? 255 : 1);
  }
  return {
    count: sink.count,
    positions: sink.positions,
    normals: hasNormals ? columnsOf(sink, 0, 3) : null,
    colours,
    notices: [...notices, ...sink.notices],
  };
}

async function readBinary(
  file: Blob,
  { bytes, format }: PlyHeader,
  vertices: PlyElement,
  before: readonly PlyElement[],
  layout: Layout,
  sink: PointSink,
  onRead: OnRead,
): Promise<void> {
  const isLittle = format === "littleEndian";
  const cursor = new FileCursor(file, bytes);
  for (const element of before) {
    const size = rowBytes(element);
    if (size !== null) cursor.at += size * element.count;
    else for (let row = 0; row < element.count; ++row) if ((await nextRow(cursor, element, isLittle)) === null) throw endsBefore();
  }
  if (cursor.at > file.size) throw endsBefore();
  const readers = vertices.properties.map(({ type }) => readerOf(type, isLittle));
  const size = rowBytes(vertices);
  if (size === null) {
    const numbers = [...layout.place, ...layout.extras];
    for (let row = 0; row < vertices.count; ++row) {
      const values = await nextRow(cursor, vertices, isLittle);
      if (values === null) return;
      put(sink, (k) => values[numbers[k]!]!);
      if (row % 65_536 === 0) onRead(cursor.at);
    }
    return;
  }
  let end = 0;
  const offsets = vertices.properties.map(({ type }) => (end += plySizes[type]) - plySizes[type]);
  const wanted = [...layout.place, ...layout.extras].map((number) => ({ at: offsets[number]!, read: readers[number]! }));
  const [x, y, z, ...extras] = wanted as [(typeof wanted)[0], (typeof wanted)[0], (typeof wanted)[0], ...typeof wanted];
  for await (const { view, records } of recordsOf(file, cursor.at, size, vertices.count, onRead)) {
    for (let row = 0, at = 0; row < records; ++row, at += size) {
      const number = sink.add(x.read(view, at + x.at), y.read(view, at + y.at), z.read(view, at + z.at));
      if (number < 0) continue;
      for (let k = 0; k < extras.length; ++k) sink.extras[number * sink.width + k] = extras[k]!.read(view, at + extras[k]!.at);
    }
  }
}

/// Adds a point whose kth number, of place and extras, is valueOf(k).
function put(sink: PointSink, valueOf: (k: number) => number): void {
  const number = sink.add(valueOf(0), valueOf(1), valueOf(2));
  if (number < 0) return;
  for (let k = 0; k < sink.width; ++k) sink.extras[number * sink.width + k] = valueOf(3 + k);
}

/// Reads a row, and goes past it. Returns its numbers, 0 for lists; null where the file ends before.
async function nextRow(cursor: FileCursor, { properties }: PlyElement, isLittle: boolean): Promise<number[] | null> {
  const values: number[] = [];
  for (const property of properties) {
    const value = await nextValue(cursor, property, isLittle);
    if (value === null) return null;
    values.push(value);
  }
  return values;
}

async function nextValue(cursor: FileCursor, { type, countType }: PlyProperty, isLittle: boolean): Promise<number | null> {
  const first = countType ?? type;
  const view = await cursor.take(plySizes[first]);
  if (view === null) return null;
  const value = readerOf(first, isLittle)(view, 0);
  if (countType === null) return value;
  cursor.at += Math.max(0, Math.floor(value) || 0) * plySizes[type];
  return 0;
}

/// Returns what was wrong with lines, as notices.
async function readText(
  file: Blob,
  header: PlyHeader,
  vertices: PlyElement,
  before: readonly PlyElement[],
  layout: Layout,
  sink: PointSink,
  onRead: OnRead,
): Promise<string[]> {
  let toSkip = before.reduce((sum, { count }) => sum + count, 0);
  let left = vertices.count;
  const faults = new LineFaults("vertex");
  const numbers = [...layout.place, ...layout.extras];
  const hasLists = rowBytes(vertices) === null;
  const columns = [...numbers]; // of the line
  const lines = new NumberLines((line) => {
    const { values, count } = line;
    if (count === 0) return left > 0;
    if (toSkip > 0) {
      toSkip -= 1;
      return true;
    }
    if (left === 0) return false;
    left -= 1;
    if (hasLists) placeColumns(vertices, values, numbers, columns);
    const isShort = columns.some((column) => column >= count);
    if (isShort) faults.note(line, sink.seen, header.lines);
    else put(sink, (k) => values[columns[k]!]!);
    return left > 0;
  });
  if (left === 0) return [];
  for await (const block of blocksOf(file, header.bytes, onRead)) if (!lines.take(block)) break;
  if (left > 0) lines.finish();
  if (lines.isTooLong) faults.tooLong(lines.line, header.lines);
  if (sink.seen === 0) faults.refuse();
  return faults.notices;
}

/// Finds the columns of properties in a line that has lists, too.
function placeColumns({ properties }: PlyElement, values: Float64Array, numbers: readonly number[], columns: number[]): void {
  let column = 0;
  const begins = properties.map(({ countType }) => {
    const begin = column;
    column += 1 + (countType === null ? 0 : Math.max(0, values[begin] ?? 0));
    return begin;
  });
  numbers.forEach((number, k) => (columns[k] = begins[number]!));
}
