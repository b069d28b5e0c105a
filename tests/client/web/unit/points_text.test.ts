import { describe, expect, it } from "vitest";

import { pointsText } from "../../../../client/web/src/app/points_text";
import { PointLimit } from "../../../../client/web/src/stream";

describe("the number of points", () => {
  it("stands alone where there are as many as wanted", () => {
    expect(pointsText(50_000, null)).toBe("50,000");
    expect(pointsText(50_000, { wantedPoints: 50_000, limit: PointLimit.UNSPECIFIED })).toBe("50,000");
    expect(pointsText(1234, { wantedPoints: 0, limit: PointLimit.BYTES })).toBe("1,234");
  });

  it("says of how many, and why there are not more", () => {
    const text = (limit: number): string => pointsText(4384, { wantedPoints: 50_000, limit });
    expect(text(PointLimit.DENSITY)).toBe("4,384 of 50,000, no more places in view");
    const known = [PointLimit.BYTES, PointLimit.DENSITY, PointLimit.SERVER, PointLimit.COMING].map(text);
    expect(new Set(known).size).toBe(4);
    expect(text(77)).toBe("4,384 of 50,000");
  });
});
