// SPDX-License-Identifier: Apache-2.0
// Lines of a file that are not what they should be: a few are left out, and a file of them is refused.

import { textOf, type NumberLine } from "./number_lines";
import { badFile, countText } from "./words";

const mostFaults = 100; // more than the points so far: the file is something else

/// Counts them.
export class LineFaults {
  private count = 0;
  private first = ""; // where and what it is

  /// `what`: a line should be.
  constructor(private readonly what: string) {}

  /// Notes a line after so many points. `before`: lines of the file that were not counted. Throws INVALID_ARGUMENT where there are too many.
  note(line: NumberLine, points: number, before = 0): void {
    if (this.count++ === 0) {
      const text = textOf(line.bytes, line.begin, line.end).replace(/[^ -~]/g, "·");
      this.first = `line ${line.line + before}, "${text}${line.end - line.begin > text.length ? "…" : ""}", is no ${this.what}`;
    }
    if (this.count > mostFaults && this.count > points) this.refuse();
  }

  /// Throws INVALID_ARGUMENT: a line is no text.
  tooLong(line: NumberLine, before = 0): never {
    throw badFile(`line ${line.line + before} is too long to be a ${this.what}`);
  }

  /// Throws INVALID_ARGUMENT: the first fault. Does nothing where there is none.
  refuse(): void {
    if (this.count > 0) throw badFile(this.first);
  }

  get notices(): string[] {
    if (this.count === 0) return [];
    const lines = this.count === 1 ? "A line was" : `${countText(this.count)} lines were`;
    return [`${lines} left out: ${this.first}`];
  }
}
