// SPDX-License-Identifier: Apache-2.0
// The points of a store on the graphics card, and the shapes that draw them.

import * as THREE from "three";
import type { PointStore } from "../stream/point_store";
import { colourScale, typicalRadius, type ColourScale } from "./colouring";
import { paintPoints } from "./painted_colours";
import { localSection } from "./section";
import type { StoreEnds } from "./discs/store_ends";
import { StoreTexture, type ColumnArray, type ColumnName } from "./store_texture";
import type { Colouring, PaintDab, Section, Style } from "./types";
import { mergeRanges } from "./update_ranges";

/// What each point is drawn as: a square in the disc's plane, or a hexagon whose middle stands out, so that neighbours meet halfway.
export type DiscShape = "square" | "cone";

const blockSlots = 1024; // shapes per instance, as in the shaders
const faces: Record<DiscShape, { corners: number; index: number[] }> = {
  square: { corners: 4, index: [0, 1, 2, 2, 1, 3] },
  cone: { corners: 7, index: [0, 1, 2, 3, 4, 5].flatMap((i) => [6, i, (i + 1) % 6]) },
};

const endColumns = [
  ["ends", "planes"],
  ["bends", "bends"],
] as const;

/// The uniforms that `pointFunctions` of the shaders reads.
export interface PointUniforms {
  [name: string]: THREE.IUniform;
  positions: THREE.IUniform<THREE.Texture | null>;
  normalsOf: THREE.IUniform<THREE.Texture | null>;
  column: THREE.IUniform<THREE.Texture | null>;
  ends: THREE.IUniform<THREE.Texture | null>;
  bends: THREE.IUniform<THREE.Texture | null>;
  slots: THREE.IUniform<number>;
  stride: THREE.IUniform<number>;
  section: THREE.IUniform<THREE.Vector4>;
}

export const makePointUniforms = (): PointUniforms => ({
  positions: { value: null },
  normalsOf: { value: null },
  column: { value: null },
  ends: { value: null },
  bends: { value: null },
  slots: { value: 0 },
  stride: { value: 1 },
  section: { value: new THREE.Vector4() },
});

/// Keeps the columns of a store as textures, and uploads what changes.
export class PointsGeometry {
  /// Discs of all slots, or of every so many. They have no attributes: the shaders compute the slot from the numbers of vertex and instance.
  readonly discs = new THREE.InstancedBufferGeometry();
  /// A vertex for each slot, or for every so many.
  readonly dots = new THREE.BufferGeometry();
  private readonly textures = new Map<ColumnName, StoreTexture>();
  private colouring: Colouring = "shading";
  private paint: readonly PaintDab[] = [];
  private painted: Uint8Array<ArrayBuffer> | null = null; // the colours under paint; null: to be computed
  private scaleNow: ColourScale;
  private radiusNow: number;
  /// Slots that are not uploaded yet; null: all.
  private pending: number[] | null = null;
  private stride = 1; // from one slot that is drawn to the next

  /// `ends`: where the discs end before their rims; null: nowhere.
  constructor(
    readonly store: PointStore,
    shape: DiscShape,
    readonly ends: StoreEnds | null = null,
  ) {
    const { corners, index } = faces[shape];
    const all = new Uint16Array(index.length * blockSlots);
    for (let i = 0; i < blockSlots; ++i)
      all.set(
        index.map((corner) => corner + i * corners),
        i * index.length,
      );
    this.discs.setIndex(new THREE.BufferAttribute(all, 1));
    this.scaleNow = colourScale(store, this.colouring);
    this.radiusNow = typicalRadius(store);
  }

  /// The scale for the colouring of the last refresh.
  get scale(): ColourScale {
    return this.scaleNow;
  }

  /// The median radius in units.
  get typicalRadius(): number {
    return this.radiusNow;
  }

  /// Takes the store's changes, and the scale for the colours of a style. Its paint has to be another array where it has changed.
  refresh({ colouring, paint, splatScale }: Pick<Style, "colouring" | "paint" | "splatScale">): void {
    const { store } = this;
    const changes = store.takeChanges();
    this.ends?.refresh(changes, splatScale);
    const changed = changes.all || changes.ranges.length > 0;
    if (changed) {
      this.radiusNow = typicalRadius(store);
      // Changes that were not uploaded before the next ones are rare: then all slots are uploaded.
      const isFirst = this.pending !== null && this.pending.length === 0;
      this.pending = changes.all || !isFirst ? null : mergeRanges(changes.ranges, store.slots);
    }
    const isRepainted = paint !== this.paint || colouring !== this.colouring;
    if (changed || isRepainted) this.scaleNow = colourScale(store, colouring, paint.length > 0);
    if (changed && this.painted?.length === store.positions.length && this.pending !== null && !isRepainted)
      paintPoints(store, paint, this.painted, this.pending);
    else if (changed || isRepainted) this.painted = null;
    this.colouring = colouring;
    this.paint = paint;
    this.thin(this.stride);
  }

  /// Draws the points of every `stride`th slot from now on. Slots follow the curve, but for those that deltas have filled: every so many
  /// are an even part of the points.
  thin(stride: number): void {
    const shapes = Math.ceil(this.store.slots / stride);
    this.stride = stride;
    this.discs.instanceCount = Math.ceil(shapes / blockSlots);
    this.dots.setDrawRange(0, shapes);
  }

  /// The factor of radii with which the points that are drawn cover as much as all of them.
  get growth(): number {
    return Math.sqrt(this.stride);
  }

  /// Uploads what has changed. To be called before drawing.
  upload(renderer: THREE.WebGLRenderer): void {
    const { store, pending } = this;
    const columns: [ColumnName, ColumnArray, number[] | null][] = [
      ["positions", store.positions, pending],
      ["normals", store.normals, pending],
    ];
    const { column } = this.scaleNow;
    const values = column === "painted" ? this.paintedColours() : column && store[column];
    if (column && values) columns.push([column, values, pending]);
    for (const [name, of] of endColumns) {
      const found = this.ends?.[of];
      if (this.ends && found) columns.push([name, found, mergeRanges(this.ends.takeChanges(of), store.slots)]);
    }
    for (const [name, texture] of this.textures) {
      if (columns.some(([wanted]) => wanted === name)) continue;
      texture.dispose();
      this.textures.delete(name);
    }
    for (const [name, array, changed] of columns) {
      const texture = this.textures.get(name) ?? new StoreTexture(name);
      this.textures.set(name, texture);
      const ranges = changed === null || texture.lacks(renderer, array) ? [0, store.slots] : changed;
      const texels = name === "ends" || name === "bends" ? ranges.map((slot) => 2 * slot) : ranges;
      if (texels.length > 0) texture.upload(renderer, array, texels);
    }
    this.pending = [];
  }

  /// Sets the uniforms of the shaders.
  apply(uniforms: PointUniforms, section: Section | null): void {
    const { column } = this.scaleNow;
    uniforms.positions.value = this.textures.get("positions")?.texture ?? null;
    uniforms.normalsOf.value = this.textures.get("normals")?.texture ?? null;
    uniforms.column.value = (column && this.textures.get(column)?.texture) ?? null;
    uniforms.bends.value = this.textures.get("bends")?.texture ?? null;
    uniforms.ends.value = this.textures.get("ends")?.texture ?? null;
    uniforms.slots.value = this.store.slots;
    uniforms.stride.value = this.stride;
    uniforms.section.value.set(...localSection(section, this.store.origin));
  }

  private paintedColours(): Uint8Array {
    const { store } = this;
    if (this.painted === null) {
      this.painted = new Uint8Array(store.positions.length);
      paintPoints(store, this.paint, this.painted, [0, store.slots]);
    }
    return this.painted;
  }

  /// refresh() and upload() make anew what this gives back.
  dispose(): void {
    this.ends?.pause();
    this.discs.dispose();
    this.dots.dispose();
    for (const texture of this.textures.values()) texture.dispose();
    this.textures.clear();
  }
}
