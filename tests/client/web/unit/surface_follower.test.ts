import { beforeEach, describe, expect, it } from "vitest";

import { SurfaceFollower } from "../../../../client/web/src/app/surface_follower";
import { CurvecastError } from "../../../../client/web/src/stream/errors";
import type { SurfaceMesh } from "../../../../client/web/src/stream/decoded_surface";
import { settle } from "./fake_web_socket";

interface Asked {
  signal: AbortSignal;
  answer(mesh: SurfaceMesh): void;
  refuse(error: CurvecastError): void;
}

const mesh: SurfaceMesh = {
  origin: [0, 0, 0],
  positions: new Float32Array(0),
  normals: new Float32Array(0),
  colours: null,
  triangles: new Uint32Array(0),
  bytes: 9,
};
const refusal = new CurvecastError("FAILED_PRECONDITION", "the surface has textures");

let asked: Asked[] = [];
let answers = 0;
let follower: SurfaceFollower;

beforeEach(() => {
  asked = [];
  answers = 0;
  follower = new SurfaceFollower(
    ({ signal }) => new Promise((answer, refuse) => asked.push({ signal, answer, refuse })),
    () => ++answers,
  );
});

describe("the surface of a session", () => {
  it("is asked for once, when it is wanted, and stays", async () => {
    follower.follow(false);
    expect(asked.length).toBe(0);
    for (let i = 0; i < 3; ++i) follower.follow(true);
    expect(asked.length).toBe(1);
    expect(follower).toMatchObject({ isAsked: true, mesh: null });
    asked[0]!.answer(mesh);
    await settle();
    expect(follower).toMatchObject({ isAsked: false, mesh, refusal: null });
    for (const isWanted of [false, true]) follower.follow(isWanted);
    expect(follower.mesh).toBe(mesh);
    expect([asked.length, answers]).toEqual([1, 1]);
  });

  it("is cancelled when it is wanted no more, and asked for anew when it is", async () => {
    follower.follow(true);
    follower.follow(false);
    expect(asked[0]!.signal.aborted).toBe(true);
    asked[0]!.refuse(new CurvecastError("CANCELLED", "cancelled"));
    await settle();
    expect(follower).toMatchObject({ isAsked: false, mesh: null, refusal: null });
    follower.follow(true);
    asked[1]!.answer(mesh);
    await settle();
    expect(follower.mesh).toBe(mesh);
    expect(answers).toBe(1);
  });

  it("that is refused is not asked for again", async () => {
    follower.follow(true);
    asked[0]!.refuse(refusal);
    await settle();
    expect(follower).toMatchObject({ isAsked: false, mesh: null, refusal });
    follower.follow(true);
    expect([asked.length, answers]).toEqual([1, 1]);
  });

  it("that comes after the end is not told", async () => {
    follower.follow(true);
    follower.close();
    asked[0]!.answer(mesh);
    await settle();
    expect(answers).toBe(0);
  });
});
