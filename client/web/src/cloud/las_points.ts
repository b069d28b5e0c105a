// SPDX-License-Identifier: Apache-2.0
// The points of a LAS file, versions 1.0 to 1.4. ASPRS, "LAS Specification 1.4 - R15", 2019.

import { bytesAt, recordsOf, type OnRead } from "./file_bytes";
import { bytesOf, columnsOf, greysOf, PointSink, type RawPoints } from "./raw_points";
import { badFile, countText, pointsText } from "./words";

const leastHeader = 227; // bytes
const headerWithCount = 375; // bytes, of version 1.4
/// Of each point format: the least bytes of a record, and where its colour is; 0: it has none.
const formats: readonly (readonly [bytes: number, colourAt: number])[] = [
  [20, 0],
  [28, 0],
  [26, 20],
  [34, 28],
  [57, 0],
  [63, 28],
  [30, 0],
  [36, 30],
  [38, 30],
  [59, 0],
  [67, 30],
];
const intensityAt = 12;
const white = 65_535;

interface LasHeader {
  pointsAt: number; // bytes from the file's beginning
  count: number; // as the file says
  recordBytes: number;
  colourAt: number;
  scale: readonly number[];
  offset: readonly number[];
}

function parseHeader(bytes: Uint8Array<ArrayBuffer>): LasHeader {
  const view = new DataView(bytes.buffer);
  if (bytes.length < leastHeader) throw badFile(`the file has ${bytes.length} bytes, and a LAS header has ${leastHeader}`);
  if (view.getUint32(0) !== 0x4c415346) throw badFile('a LAS file begins with "LASF"');
  const code = view.getUint8(104);
  if (code >= 64) throw badFile("its points are compressed (LAZ): uncompress it first, for example by laszip or pdal translate");
  const format = formats[code];
  if (format === undefined) throw badFile(`there is no point format ${code} (byte 104)`);
  const [leastBytes, colourAt] = format;
  const recordBytes = view.getUint16(105, true);
  if (recordBytes < leastBytes)
    throw badFile(`points of format ${code} have ${leastBytes} bytes at least, and not ${recordBytes} (byte 105)`);
  const doubles = (at: number): number[] => [0, 8, 16].map((more) => view.getFloat64(at + more, true));
  const hasLargeCount = view.getUint8(25) >= 4 && bytes.length >= headerWithCount;
  const largeCount = hasLargeCount ? Number(view.getBigUint64(247, true)) : 0;
  return {
    pointsAt: view.getUint32(96, true),
    count: largeCount > 0 ? largeCount : view.getUint32(107, true),
    recordBytes,
    colourAt,
    scale: doubles(131),
    offset: doubles(155),
  };
}

/// Reads the points of a file, with its colours, or greys by intensity. Those after which it breaks off are kept, and a notice tells of
/// the rest. Throws INVALID_ARGUMENT where there is none to be read, or they are compressed.
export async function readLasPoints(file: Blob, onRead: OnRead, most?: number): Promise<RawPoints> {
  const header = parseHeader(await bytesAt(file, 0, headerWithCount));
  const { pointsAt, count, recordBytes, colourAt, scale, offset } = header;
  if (pointsAt < leastHeader || pointsAt > file.size)
    throw badFile(`its points begin at byte ${pointsAt} of ${file.size} (byte 96)`);
  const [sx, sy, sz] = scale as [number, number, number];
  const [ox, oy, oz] = offset as [number, number, number];
  const sink = new PointSink(colourAt > 0 ? 4 : 1, most);
  for await (const { view, records } of recordsOf(file, pointsAt, recordBytes, count, onRead)) {
    for (let i = 0, at = 0; i < records; ++i, at += recordBytes) {
      const number = sink.add(
        view.getInt32(at, true) * sx + ox,
        view.getInt32(at + 4, true) * sy + oy,
        view.getInt32(at + 8, true) * sz + oz,
      );
      if (number < 0) continue;
      const { extras, width } = sink;
      extras[width * number] = view.getUint16(at + intensityAt, true);
      for (let k = 1; k < width; ++k) extras[width * number + k] = view.getUint16(at + colourAt + 2 * (k - 1), true);
    }
  }
  if (sink.seen === 0 && count > 0) throw badFile(`the file ends before the first of its ${pointsText(count)}`);
  const isCut = sink.seen < count;
  return {
    count: sink.count,
    positions: sink.positions,
    normals: null,
    colours: (colourAt > 0 ? coloursOf(columnsOf(sink, 1, 3)) : null) ?? greysOf(columnsOf(sink, 0, 1)),
    notices: [...(isCut ? [`The file ends after ${countText(sink.seen)} of ${pointsText(count)}`] : []), ...sink.notices],
  };
}

/// Colours have 16 bits, though some programs write bytes. All black: there are none.
function coloursOf(values: Float32Array): Uint8Array | null {
  const most = values.reduce((largest, value) => Math.max(largest, value), 0);
  return most === 0 ? null : bytesOf(values, most <= 255 ? 255 : white);
}
