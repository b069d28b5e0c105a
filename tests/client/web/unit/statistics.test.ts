import { describe, expect, it } from "vitest";

import { PointLimit } from "../../../../client/web/src/gen/curvecast/v1/curvecast_pb";
import { quantile, Statistics, type FrameReport } from "../../../../client/web/src/stream/statistics";

function frame(bytes: number, viewSeconds: number | null): FrameReport {
  return {
    sequence: 1,
    isDelta: true,
    points: 1,
    wantedPoints: 1,
    limit: PointLimit.UNSPECIFIED,
    added: 0,
    removed: 0,
    resized: 0,
    bytes,
    viewSeconds,
    serverSeconds: 0,
    decodeSeconds: 0,
    storeSeconds: 0,
    refining: false,
    curveRevision: 1,
    curveVertices: 1,
    error: null,
  };
}

describe("statistics", () => {
  it("have quantiles that are values", () => {
    expect(quantile([], 0.5)).toBeNull();
    expect(quantile([3], 0.99)).toBe(3);
    expect(quantile([4, 1, 3, 2], 0.5)).toBe(2);
    expect(
      quantile(
        Array.from({ length: 100 }, (_, i) => i + 1),
        0.99,
      ),
    ).toBe(99);
  });

  it("count bytes of the last five seconds, and the last 200 views that were answered", () => {
    const statistics = new Statistics();
    for (let i = 0; i < 1000; ++i) {
      statistics.add(frame(10, i), i / 100);
      statistics.add(frame(10, null), i / 100);
    }
    const summary = statistics.summary(9.99);
    expect(summary.frames).toBe(2000);
    expect(summary.bytes).toBe(20_000);
    expect(summary.bytesPerSecond).toBeCloseTo(2000, -1);
    expect(summary.viewP50).toBe(899);
    expect(summary.viewP99).toBe(997);
    expect(statistics.summary(100).bytesPerSecond).toBe(0);
  });

  it("have the rate of a young stream", () => {
    const statistics = new Statistics();
    expect(statistics.summary(50).bytesPerSecond).toBe(0);
    statistics.add(frame(600, null), 50);
    expect(statistics.summary(50).bytesPerSecond).toBe(600); // not more than in a second
    statistics.add(frame(600, null), 51);
    expect(statistics.summary(52).bytesPerSecond).toBe(600);
    expect(statistics.summary(54).bytesPerSecond).toBe(300);
  });
});
