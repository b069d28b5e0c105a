// SPDX-License-Identifier: Apache-2.0
// Colour maps as textures, and the uniforms of a ColourScale.

import * as THREE from "three";
import { makeColourMap, mapSize, type MapName } from "./colour_maps";
import type { ColourScale } from "./colouring";

/// The uniforms that `splatColour` of the shaders reads.
export interface ColourUniforms {
  [name: string]: THREE.IUniform;
  map: THREE.IUniform<THREE.Texture | null>;
  mapScale: THREE.IUniform<number>;
  mapOffset: THREE.IUniform<number>;
}

export const makeColourUniforms = (): ColourUniforms => ({ map: { value: null }, mapScale: { value: 1 }, mapOffset: { value: 0 } });

/// Keeps the textures of the maps. Makes each when it is first needed.
export class ColourTextures {
  private readonly textures = new Map<MapName, THREE.DataTexture>();

  /// Sets the uniforms for a scale.
  apply(scale: ColourScale, uniforms: ColourUniforms): void {
    uniforms.map.value = scale.map ? this.texture(scale.map) : null;
    uniforms.mapScale.value = scale.scale;
    uniforms.mapOffset.value = scale.offset;
  }

  dispose(): void {
    for (const texture of this.textures.values()) texture.dispose();
    this.textures.clear();
  }

  private texture(name: MapName): THREE.DataTexture {
    const known = this.textures.get(name);
    if (known) return known;
    const texture = new THREE.DataTexture(makeColourMap(name), mapSize, 1);
    texture.minFilter = texture.magFilter = THREE.LinearFilter;
    texture.needsUpdate = true;
    this.textures.set(name, texture);
    return texture;
  }
}
