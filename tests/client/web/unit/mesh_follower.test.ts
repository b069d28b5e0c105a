import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";

import { MeshFollower } from "../../../../client/web/src/app/mesh_follower";
import { CurvecastError } from "../../../../client/web/src/stream/errors";
import { StreamedPoints } from "../../../../client/web/src/stream/point_store";
import type { TriangleMesh } from "../../../../client/web/src/stream/triangle_mesh";

/// A request that the server has yet to answer.
interface Asked {
  points: bigint;
  relaxations: number | undefined;
  signal: AbortSignal;
  answer(): Promise<void>;
  fail(error: CurvecastError): Promise<void>;
}

let asked: Asked[] = [];
let meshes: (bigint | null)[] = []; // what the page was given, by the number of points that was asked for
let failures: string[] = [];
const made = new Map<TriangleMesh, bigint>();

const sample = (points: number) => ({ budget: { case: "points" as const, value: BigInt(points) } });
const running = () => asked.filter(({ signal }) => !signal.aborted && !answered.has(signal)).map(({ points }) => points);
const answered = new Set<AbortSignal>();
const rest = () => vi.advanceTimersByTimeAsync(1000);

function makeFollower(): MeshFollower {
  const remesh: ConstructorParameters<typeof MeshFollower>[0] = ({ budget }, { relaxations, signal }) =>
    new Promise((resolve, reject) => {
      const points = budget?.value as bigint;
      signal!.addEventListener("abort", () => reject(new CurvecastError("CANCELLED", "cancelled")));
      const over = async (end: () => void) => {
        answered.add(signal!);
        end();
        await vi.advanceTimersByTimeAsync(0);
      };
      asked.push({
        points,
        relaxations,
        signal: signal!,
        answer: () =>
          over(() => {
            const mesh = { vertices: new StreamedPoints(), triangles: new Uint32Array(0) };
            made.set(mesh, points);
            resolve(mesh);
          }),
        fail: (error) => over(() => reject(error)),
      });
      expect(running().length, "one at a time").toBeLessThanOrEqual(1);
    });
  return new MeshFollower(remesh, {
    onMesh: (mesh) => meshes.push(mesh === null ? null : made.get(mesh)!),
    onFailure: ({ message }) => failures.push(message),
  });
}

beforeEach(() => {
  asked = [];
  meshes = [];
  failures = [];
  vi.useFakeTimers();
});
afterEach(() => {
  vi.useRealTimers();
});

describe("a mesh at rest", () => {
  it("is asked for once, with all relaxations, when the density no longer changes", async () => {
    const follower = makeFollower();
    for (let i = 1; i <= 20; ++i) {
      follower.follow(sample(i), false);
      await vi.advanceTimersByTimeAsync(20);
    }
    expect(asked).toEqual([]);
    expect(follower.isCurrent).toBe(false);
    await rest();
    expect(asked).toMatchObject([{ points: 20n, relaxations: undefined }]);
    await asked[0]!.answer();
    expect(meshes).toEqual([20n]);
    expect(follower.isCurrent).toBe(true);
    for (const isPainting of [false, true, false]) follower.follow(sample(20), isPainting);
    await rest();
    expect(asked.length, "nothing has changed").toBe(1);
  });

  it("is cancelled when it is overtaken, and the one before stays until the newest comes", async () => {
    const follower = makeFollower();
    follower.follow(sample(1), false);
    await rest();
    await asked[0]!.answer();
    for (const points of [2, 3, 4]) {
      follower.follow(sample(points), false);
      await rest();
    }
    expect(asked.map(({ signal }) => signal.aborted)).toEqual([false, true, true, false]);
    expect(meshes).toEqual([1n]);
    await asked[3]!.answer();
    expect(meshes).toEqual([1n, 4n]);
    expect(failures, "being cancelled is no failure").toEqual([]);
  });

  it("goes at once when it is no longer wanted, and is asked for again later", async () => {
    const follower = makeFollower();
    follower.follow(null, false);
    expect(meshes).toEqual([]);
    follower.follow(sample(1), false);
    await rest();
    await asked[0]!.answer();
    follower.follow(sample(2), false);
    await rest();
    follower.follow(null, false);
    expect(meshes).toEqual([1n, null]);
    expect(follower.mesh).toBeNull();
    expect(follower.isCurrent).toBe(true);
    expect(asked[1]!.signal.aborted).toBe(true);
    follower.follow(sample(1), false);
    follower.follow(null, false);
    await rest();
    expect(asked.length).toBe(2);
    follower.follow(sample(1), false);
    await rest();
    await asked[2]!.answer();
    expect(meshes).toEqual([1n, null, 1n]);
  });

  it("that cannot be made is told once, and the one before stays", async () => {
    const follower = makeFollower();
    follower.follow(sample(2), false);
    await rest();
    await asked[0]!.answer();
    follower.follow(sample(1), false);
    await rest();
    await asked[1]!.fail(new CurvecastError("INVALID_ARGUMENT", "too few"));
    follower.follow(sample(1), false);
    await rest();
    expect(failures).toEqual(["too few"]);
    expect(meshes).toEqual([2n]);
    expect(asked.length).toBe(2);
    expect(follower.isCurrent).toBe(true);
  });
});

describe("a mesh under the brush", () => {
  it("follows the stroke at the server's pace, without a queue, and is refined at its end", async () => {
    const follower = makeFollower();
    follower.follow(sample(1), true);
    expect(asked, "at once").toMatchObject([{ points: 1n, relaxations: 1 }]);
    for (const points of [2, 3, 4, 5]) follower.follow(sample(points), true);
    expect(running()).toEqual([1n]);
    await asked[0]!.answer();
    expect(running(), "those between were never asked for").toEqual([5n]);
    expect(meshes).toEqual([1n]);
    follower.follow(sample(6), true);
    follower.follow(sample(6), false);
    expect(asked[1]!.signal.aborted, "overtaken by the end of the stroke").toBe(true);
    await rest();
    expect(asked.slice(2)).toMatchObject([{ points: 6n, relaxations: undefined }]);
    await asked[2]!.answer();
    expect(meshes).toEqual([1n, 6n]);
  });

  it("is made more regular where the stroke ends with what was meshed last", async () => {
    const follower = makeFollower();
    follower.follow(sample(1), true);
    await asked[0]!.answer();
    expect(follower.isCurrent).toBe(true);
    follower.follow(sample(1), false);
    expect(follower.isCurrent).toBe(false);
    await rest();
    expect(asked.map(({ relaxations }) => relaxations)).toEqual([1, undefined]);
    expect(meshes).toEqual([1n]);
  });

  it("overtakes one at rest", async () => {
    const follower = makeFollower();
    follower.follow(sample(1), false);
    await rest();
    follower.follow(sample(2), true);
    expect(asked[0]!.signal.aborted).toBe(true);
    expect(running()).toEqual([2n]);
    await asked[1]!.fail(new CurvecastError("INVALID_ARGUMENT", "too few"));
    follower.follow(sample(3), true);
    expect(running()).toEqual([3n]);
    follower.close();
    await rest();
    expect(running()).toEqual([]);
    expect(meshes).toEqual([]);
    expect(failures).toEqual(["too few"]);
  });
});
