// SPDX-License-Identifier: Apache-2.0
// Draws the surface's own triangles as the discs' passes draw theirs: normals and colours for the shading of each pixel. Several
// samples a pixel make smooth outlines; their mean has the share of the pixel that the surface covers.

import * as THREE from "three";
import { dropFloatTarget, makeFloatTarget } from "./float_target";
import type { Picture } from "./picture";
import { localSection } from "./section";
import type { SurfaceGeometry } from "./surface_geometry";
import { surfaceFragmentShader, surfaceVertexShader } from "./surface_shaders";

const fineSamples = 4;

/// Draws surfaces. Precondition: as of SplatPasses.
export class SurfacePass {
  private target: THREE.WebGLRenderTarget | null = null;
  private readonly uniforms = { section: { value: new THREE.Vector4() } };
  private readonly materials = new Map<string, THREE.RawShaderMaterial>();
  private readonly mesh = new THREE.Mesh<THREE.BufferGeometry, THREE.Material>();

  constructor(private readonly renderer: THREE.WebGLRenderer) {
    this.mesh.frustumCulled = false;
  }

  /// Returns what was drawn, until the next call: as SplatPasses has it, but that the fourth number of normals and of colours is the
  /// share of the pixel that is covered. There are colours where the style wants some that the surface has.
  render({ mesh, triangles }: SurfaceGeometry, { style, camera, where, isQuick }: Picture): THREE.WebGLRenderTarget {
    const { renderer } = this;
    const { colouring } = style;
    const kind = colouring === "normal" ? "NORMALS" : colouring === "colour" && mesh.colours !== null ? "OWN" : "NONE";
    const target = this.targetOf(where.width, where.height, kind !== "NONE", isQuick ? 0 : fineSamples);
    this.uniforms.section.value.set(...localSection(style.section, mesh.origin));
    this.mesh.geometry = triangles;
    this.mesh.material = this.materialOf(kind);
    this.mesh.position.fromArray(mesh.origin);
    renderer.setRenderTarget(target);
    renderer.setClearColor(0x000000, 0);
    renderer.clear();
    renderer.render(this.mesh, camera);
    return target;
  }

  dispose(): void {
    dropFloatTarget(this.target);
    this.target = null;
    for (const material of this.materials.values()) material.dispose();
    this.materials.clear();
  }

  private materialOf(kind: "NONE" | "NORMALS" | "OWN"): THREE.RawShaderMaterial {
    const made =
      this.materials.get(kind) ??
      new THREE.RawShaderMaterial({
        vertexShader: surfaceVertexShader,
        fragmentShader: surfaceFragmentShader,
        uniforms: this.uniforms,
        glslVersion: THREE.GLSL3,
        side: THREE.DoubleSide,
        defines: { [`${kind}_COLOURS`]: "" },
      });
    this.materials.set(kind, made);
    return made;
  }

  private targetOf(width: number, height: number, hasColours: boolean, samples: number): THREE.WebGLRenderTarget {
    const count = hasColours ? 2 : 1;
    if (this.target?.textures.length !== count || this.target.samples !== samples) {
      dropFloatTarget(this.target);
      this.target = makeFloatTarget(width, height, count, samples);
    }
    this.target.setSize(width, height);
    return this.target;
  }
}
