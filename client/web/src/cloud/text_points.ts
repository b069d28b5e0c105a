// SPDX-License-Identifier: Apache-2.0
// Points in lines of text: XYZ, TXT, ASC, PTS, CSV.

import { blocksOf, type OnRead } from "./file_bytes";
import { LineFaults } from "./line_faults";
import { NumberLines, type NumberLine } from "./number_lines";
import { PointSink, type RawPoints } from "./raw_points";
import { columnsWanted, guessedAttributes, namedAttributes, namedColumns, type NamedColumns } from "./text_columns";
import { badFile } from "./words";

const mostExtras = 9; // columns after x, y, z that are looked at
const longestNames = 4096; // bytes of a line of names
const byteOrderMark = [0xef, 0xbb, 0xbf];

/// Reads a file with a point in each line: numbers between blanks, tabs, commas or semicolons. Lines before the points may name the
/// columns; without names, x, y and z come first. Comments (#, //) and lines with a single number, the count of PTS files, are left out.
/// Throws INVALID_ARGUMENT where there is no point, or hardly a line is one.
export async function readTextPoints(file: Blob, onRead: OnRead, most?: number): Promise<RawPoints> {
  const rows = new PointRows(most);
  const lines = new NumberLines((line) => (rows.take(line), true));
  let isFirst = true;
  for await (const block of blocksOf(file, 0, onRead)) {
    const hasMark = isFirst && byteOrderMark.every((byte, i) => block[i] === byte);
    isFirst = false;
    if (!lines.take(hasMark ? block.subarray(3) : block)) break;
  }
  lines.finish();
  if (lines.isTooLong) rows.faults.tooLong(lines.line);
  return rows.points();
}

/// Takes lines. The first with three numbers decides how many columns there are.
class PointRows {
  readonly faults = new LineFaults("row of numbers with x, y and z");
  private sink: PointSink | null = null;
  private named: NamedColumns | null = null;
  private columns = 0; // that a line has to have
  private place: readonly [number, number, number] = [0, 1, 2];
  private extras: readonly number[] = [];
  private hasNames = false; // a line of words was before the points

  constructor(private readonly most?: number) {}

  take(line: NumberLine): void {
    const { count } = line;
    if (this.sink === null && count <= 0) return this.takeNames(line);
    if (count === 0 || count === 1) return;
    if (count < 0 || count < Math.max(3, this.columns)) return this.faults.note(line, this.sink?.seen ?? 0);
    const sink = (this.sink ??= this.begin(count));
    const { values } = line;
    const [x, y, z] = this.place;
    const number = sink.add(values[x]!, values[y]!, values[z]!);
    if (number < 0) return;
    const at = number * sink.width;
    for (let k = 0; k < this.extras.length; ++k) sink.extras[at + k] = values[this.extras[k]!]!;
  }

  points(): RawPoints {
    const { sink, named } = this;
    if (sink === null) {
      this.faults.refuse();
      throw badFile("there is no row of numbers with x, y and z in it");
    }
    const attributes = named === null ? guessedAttributes(sink) : namedAttributes(sink, named);
    return {
      count: sink.count,
      positions: sink.positions,
      ...attributes,
      notices: [...this.faults.notices, ...sink.notices],
    };
  }

  /// Takes a line without numbers before the points: a comment, or one line that has words.
  private takeNames(line: NumberLine): void {
    const { bytes, begin, end, count } = line;
    if (end > begin && end - begin < longestNames) {
      this.named = namedColumns(new TextDecoder().decode(bytes.subarray(begin, end))) ?? this.named;
    }
    if (count < 0 && this.hasNames) this.faults.note(line, 0);
    if (count < 0) this.hasNames = true;
  }

  private begin(count: number): PointSink {
    const { named } = this;
    const wanted = named === null ? [] : columnsWanted(named);
    if (named !== null && Math.max(...named.place, ...wanted) < count) {
      this.place = named.place;
      this.extras = wanted;
      this.columns = Math.max(...named.place, ...wanted) + 1;
    } else {
      this.named = null; // the names are of something else
      this.extras = Array.from({ length: Math.min(count - 3, mostExtras) }, (_, i) => 3 + i);
      this.columns = 3 + this.extras.length;
    }
    return new PointSink(this.extras.length, this.most);
  }
}
