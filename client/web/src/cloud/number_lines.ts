// SPDX-License-Identifier: Apache-2.0
// Numbers in lines of text, parsed from the bytes: a browser's texts end at half a gigabyte, and files do not.

const mostNumbers = 64; // of a line that count
const longestLine = 1 << 16; // bytes
const exactDigits = 15; // of a number whose digits are exact as an integer
const powers = Float64Array.from({ length: 23 }, (_, i) => Number(`1e${i}`)); // all of them exact

/// What a line has: the numbers of its first columns, and how many there are.
export interface NumberLine {
  /// Written anew for each line.
  readonly values: Float64Array;
  /// Numbers in the line, NaN and infinities among them; 0: the line is empty or a comment; -1: it has something else.
  count: number;
  /// From 1 on.
  line: number;
  /// The line's bytes from `begin` to `end`.
  bytes: Uint8Array;
  begin: number;
  end: number;
}

const newline = 10,
  carriageReturn = 13;

/// Returns whether a byte stands between numbers.
const isGap = (byte: number): boolean => byte === 32 || byte === 9 || byte === 44 || byte === 59;
const isDigit = (byte: number | undefined): byte is number => byte !== undefined && byte >= 48 && byte <= 57;

/// Words that files have for numbers that are none.
const noNumbers = /^[+-]?(nan|inf(inity)?|1\.#\w+)(\(\w+\))?$/i;

/// Takes blocks of bytes, and calls `onLine` for each line, until that returns false.
export class NumberLines {
  readonly line: NumberLine = {
    values: new Float64Array(mostNumbers),
    count: 0,
    line: 0,
    bytes: new Uint8Array(0),
    begin: 0,
    end: 0,
  };
  /// A line was longer than lines of numbers are: nothing more is read.
  isTooLong = false;
  private rest = new Uint8Array(0); // of the block before
  private at = 0; // in the bytes of the line

  constructor(private readonly onLine: (line: NumberLine) => boolean) {}

  /// Takes the next bytes. Returns whether more are wanted.
  take(block: Uint8Array): boolean {
    let bytes = block;
    if (this.rest.length > 0) {
      bytes = new Uint8Array(this.rest.length + block.length);
      bytes.set(this.rest);
      bytes.set(block, this.rest.length);
    }
    let begin = 0;
    for (let at = this.rest.length; at < bytes.length; ++at) {
      const byte = bytes[at]!;
      if (byte !== newline && byte !== carriageReturn) continue;
      if (at + 1 === bytes.length && byte === carriageReturn) break; // a newline may follow
      if (!this.read(bytes, begin, at)) return false;
      if (byte === carriageReturn && bytes[at + 1] === newline) ++at;
      begin = at + 1;
    }
    if (bytes.length - begin > longestLine) return this.refuse();
    this.rest = bytes.slice(begin);
    return true;
  }

  /// Takes the last line, where nothing ends it.
  finish(): void {
    const { rest } = this;
    const end = rest.at(-1) === carriageReturn ? rest.length - 1 : rest.length;
    if (end > 0) this.read(rest, 0, end);
    this.rest = new Uint8Array(0);
  }

  private read(bytes: Uint8Array, begin: number, end: number): boolean {
    if (end - begin > longestLine) return this.refuse();
    const { line } = this;
    line.line += 1;
    line.bytes = bytes;
    line.begin = begin;
    line.end = end;
    line.count = this.parse();
    return this.onLine(line);
  }

  private refuse(): boolean {
    this.isTooLong = true;
    this.line.line += 1;
    return false;
  }

  private parse(): number {
    const { bytes, begin, end, values } = this.line;
    let count = 0;
    for (let at = begin; ;) {
      while (at < end && isGap(bytes[at]!)) ++at;
      if (at === end) return count;
      const byte = bytes[at]!;
      if (byte === 35 || (byte === 47 && bytes[at + 1] === 47)) return count; // # and //
      this.at = at;
      const value = this.number(end);
      if (value === null) return -1;
      if (count < mostNumbers) values[count++] = value;
      at = this.at;
    }
  }

  /// Parses a number, and goes past it. Returns null where it is none.
  private number(end: number): number | null {
    const { bytes } = this.line;
    const begin = this.at;
    let at = begin;
    const isNegative = bytes[at] === 45;
    if (isNegative || bytes[at] === 43) ++at;
    let digits = 0;
    let decimals = 0;
    let value = 0;
    for (; at < end && isDigit(bytes[at]); ++at, ++digits) value = 10 * value + (bytes[at]! - 48);
    if (at < end && bytes[at] === 46) {
      ++at;
      for (; at < end && isDigit(bytes[at]); ++at, ++digits, ++decimals) value = 10 * value + (bytes[at]! - 48);
    }
    if (digits > 0 && digits <= exactDigits && (at === end || isGap(bytes[at]!))) {
      this.at = at;
      const size = value / powers[decimals]!; // both exact: correctly rounded
      return isNegative ? -size : size;
    }
    while (at < end && !isGap(bytes[at]!)) ++at;
    this.at = at;
    const word = textOf(bytes, begin, at);
    if (noNumbers.test(word)) return NaN;
    // Number() takes more than decimal numbers.
    return /^[+-]?(\d+\.?\d*|\.\d+)([ed][+-]?\d+)?$/i.test(word) ? Number(word.replace(/d/i, "e")) : null;
  }
}

/// Returns bytes as a text, a character a byte, and at most 40 of them.
export function textOf(bytes: Uint8Array, begin: number, end: number): string {
  return String.fromCharCode(...bytes.subarray(begin, Math.min(end, begin + 40)));
}
