// SPDX-License-Identifier: Apache-2.0
// How many points the automatic budget may have, by the time that drawing them takes: the server sees frames taken in, not drawn.

const stillPictures = 3; // times as long as a frame may take: moving pictures are coarser
const fewest = 5000;
const most = 200_000; // the server's own bound
const growth = 1.5;

/// Bounds points by measured drawing times.
export class DrawingBudget {
  private bound = most;

  /// Points of a view, at most.
  get mostPoints(): number {
    return this.bound;
  }

  /// Notes that a fine picture of so many points took so long to draw. `frameMilliseconds`: that a frame may take. Returns whether the
  /// bound has changed: only for a picture that is clearly too slow, or clearly fast, so that the bound comes to rest.
  note(points: number, milliseconds: number, frameMilliseconds: number): boolean {
    const before = this.bound;
    const share = (stillPictures * frameMilliseconds) / Math.max(milliseconds, 1);
    if (share < 0.8) this.bound = Math.max(fewest, Math.min(before, rounded(points * Math.max(share, 0.2))));
    else if (share > 2 && points > 0.8 * before) this.bound = Math.min(most, rounded(before * growth));
    return this.bound !== before;
  }
}

/// Two digits suffice.
const rounded = (value: number): number => Number(value.toPrecision(2));
