// SPDX-License-Identifier: Apache-2.0
// A material that draws opaque discs in one pass, with a light at the eye.

import * as THREE from "three";
import { ColourTextures, makeColourUniforms } from "./colour_texture";
import { makePointUniforms, type PointsGeometry } from "./points_geometry";
import { solidFragmentShader, solidVertexShader } from "./splat_shaders";
import type { Style } from "./types";

/// Draws geometries of the shape "cone". Dots hide nothing, and those on the far side are left out.
export class SolidMaterial extends THREE.ShaderMaterial {
  private readonly textures = new ColourTextures();
  private readonly colourUniforms = makeColourUniforms();
  private readonly pointUniforms = makePointUniforms();
  private readonly styleUniforms = {
    splatScale: { value: 1 },
    backShift: { value: 0 },
    extent: { value: 1.1547 }, // of hexagons around the discs
    minRadius: { value: 0 },
    dotDiameter: { value: 0 },
    pixels: { value: new THREE.Vector2(1, 1) },
    plainColour: { value: new THREE.Color(0xd2b79f) },
  };

  constructor() {
    super({
      vertexShader: solidVertexShader,
      fragmentShader: solidFragmentShader,
      defines: { COLOURING: 0 },
      side: THREE.DoubleSide,
    });
    this.uniforms = { ...this.pointUniforms, ...this.colourUniforms, ...this.styleUniforms };
  }

  /// Sets the uniforms for a picture of so many pixels. To be called before drawing.
  prepare(points: PointsGeometry, style: Style, width: number, height: number, pixelRatio: number, camera: THREE.Camera): void {
    const { scale } = points;
    points.apply(this.pointUniforms, style.section);
    this.textures.apply(scale, this.colourUniforms);
    if (this.defines.COLOURING !== scale.kind) {
      this.defines.COLOURING = scale.kind;
      this.needsUpdate = true;
    }
    const hasBothSides = !points.store.isSurface;
    if (hasBothSides !== (this.defines.BOTH_SIDES === "")) {
      if (hasBothSides) this.defines.BOTH_SIDES = "";
      else delete this.defines.BOTH_SIDES;
      this.needsUpdate = true;
    }
    const uniforms = this.styleUniforms;
    uniforms.pixels.value.set(width, height);
    uniforms.splatScale.value = style.splatScale * points.growth;
    uniforms.dotDiameter.value = style.mode === "dots" ? style.dotSize * pixelRatio : 0;
    uniforms.minRadius.value = 1 / (height * camera.projectionMatrix.elements[5]);
    this.uniformsNeedUpdate = true;
  }

  override dispose(): void {
    this.textures.dispose();
    super.dispose();
  }
}
