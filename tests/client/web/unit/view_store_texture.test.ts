import type * as THREE from "three";
import { expect, test } from "vitest";

import { StoreTexture } from "../../../../client/web/src/view/store_texture";

/// A renderer whose textures have these handles; null: its context is lost.
function makeRenderer(handleNow: () => object | null): THREE.WebGLRenderer {
  const handles = new Map<unknown, object | null>();
  return {
    initTexture: (texture: unknown) => handles.set(texture, handleNow()),
    getContext: () => ({ pixelStorei: () => {}, texSubImage2D: () => {} }),
    state: { bindTexture: () => {}, unbindTexture: () => {} },
    properties: { get: (texture: unknown) => ({ __webglTexture: handles.get(texture) ?? undefined }) },
  } as unknown as THREE.WebGLRenderer;
}

test("an array that was uploaded is not lacking, until it is another one", () => {
  const renderer = makeRenderer(() => ({}));
  const texture = new StoreTexture("positions");
  const array = new Float32Array(8);
  expect(texture.lacks(renderer, array)).toBe(true);
  texture.upload(renderer, array, [0, 2]);
  expect(texture.lacks(renderer, array)).toBe(false);
  expect(texture.lacks(renderer, new Float32Array(8))).toBe(true);
});

test("an array is lacking where the graphics card was lost, before or after it was uploaded", () => {
  const array = new Float32Array(8);
  const lost = makeRenderer(() => null);
  const early = new StoreTexture("positions");
  early.upload(lost, array, [0, 2]);
  expect(early.lacks(lost, array)).toBe(true);
  const texture = new StoreTexture("positions");
  texture.upload(
    makeRenderer(() => ({})),
    array,
    [0, 2],
  );
  expect(
    texture.lacks(
      makeRenderer(() => ({})),
      array,
    ),
  ).toBe(true); // its handles are new
});
