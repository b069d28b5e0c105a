// SPDX-License-Identifier: Apache-2.0
// The points of a stream in any three.js scene.

import * as THREE from "three";
import type { PointStore } from "../stream/point_store";
import { PointsGeometry } from "./points_geometry";
import { SolidMaterial } from "./solid_material";
import { defaultStyle, type Style } from "./types";

/// Draws points as opaque discs, in one pass, with the scene's depth and a light at the eye: for any renderer, camera and
/// transformation. Dots hide nothing, and those on the far side are left out. The style's background and edl have no effect.
export class CurvecastPoints extends THREE.Object3D {
  /// How points are drawn. Assign a new object to change it: refresh() applies it.
  style: Style = { ...defaultStyle };
  private readonly points: PointsGeometry;
  private readonly material = new SolidMaterial();
  private readonly mesh: THREE.Mesh;

  constructor(private readonly store: PointStore) {
    super();
    this.points = new PointsGeometry(store, "cone");
    this.mesh = new THREE.Mesh(this.points.discs, this.material);
    this.mesh.frustumCulled = false;
    // The shader places the triangles: three.js cannot hit them with a ray.
    this.mesh.raycast = () => {};
    const size = new THREE.Vector2();
    this.mesh.onBeforeRender = (renderer, _scene, camera) => {
      this.points.upload(renderer);
      const target = renderer.getRenderTarget();
      if (target) size.set(target.width, target.height);
      else renderer.getDrawingBufferSize(size);
      this.material.prepare(this.points, this.style, size.x, size.y, target ? 1 : renderer.getPixelRatio(), camera);
    };
    this.add(this.mesh);
    this.refresh();
  }

  /// Takes the store's changes. Rendering the scene calls it.
  refresh(): void {
    this.points.refresh(this.style);
    this.mesh.position.fromArray(this.store.origin);
  }

  /// Is called by the scene before it is drawn.
  override updateMatrixWorld(force?: boolean): void {
    this.refresh();
    super.updateMatrixWorld(force);
  }

  dispose(): void {
    this.points.dispose();
    this.material.dispose();
    this.clear();
  }
}
