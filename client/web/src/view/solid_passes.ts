// SPDX-License-Identifier: Apache-2.0
// Draws pictures without floating point targets: opaque discs before a plain background.

import * as THREE from "three";
import { looks, type Passes, type Picture } from "./picture";
import { SolidMaterial } from "./solid_material";

/// Draws pictures on graphics cards that cannot blend floating point targets.
export class SolidPasses implements Passes {
  readonly shape = "cone";
  readonly drawsSurfaces = false;
  readonly depths = null;
  private readonly material = new SolidMaterial();
  private readonly mesh = new THREE.Mesh(new THREE.BufferGeometry(), this.material);

  constructor(private readonly renderer: THREE.WebGLRenderer) {
    this.mesh.frustumCulled = false;
  }

  render({ points, style, camera, where, pixelRatio }: Picture): void {
    const { renderer, mesh } = this;
    const look = looks[style.background];
    renderer.setViewport(where.x, where.y, where.width, where.height);
    renderer.setScissor(where.x, where.y, where.width, where.height);
    renderer.setClearColor(look.top.clone().lerp(look.bottom, 0.5));
    renderer.clear();
    if (!points) return;
    this.material.prepare(points, style, where.width, where.height, pixelRatio, camera);
    mesh.geometry = points.discs;
    mesh.position.fromArray(points.store.origin);
    renderer.render(mesh, camera);
  }

  dispose(): void {
    this.material.dispose();
  }
}
