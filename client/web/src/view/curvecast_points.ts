// Points of a stream in any three.js scene.

import * as THREE from "three";
import type { PointStore } from "../stream/point_store";
import { PointsGeometry } from "./points_geometry";
import { SolidMaterial } from "./solid_material";
import { defaultStyle, type Style } from "./types";

/// Opaque discs, drawn in one pass with the scene's depth and lit by a light at the eye: any renderer, camera and transformation will
/// do. Dots hide nothing; those on the far side are left out. The style's background and edl are the scene's affair.
export class CurvecastPoints extends THREE.Object3D {
  /// Assign a new object to change it; it counts from the next refresh on.
  style: Style = { ...defaultStyle };
  private readonly points: PointsGeometry;
  private readonly material = new SolidMaterial();
  private readonly mesh: THREE.Mesh;

  constructor(private readonly store: PointStore) {
    super();
    this.points = new PointsGeometry(store, "cone");
    this.mesh = new THREE.Mesh(this.points.discs, this.material);
    this.mesh.frustumCulled = false;
    // Its triangles are where the shader puts them.
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

  /// Takes the store's changes; rendering the scene does so by itself.
  refresh(): void {
    this.points.refresh(this.style.colouring);
    this.mesh.position.fromArray(this.store.origin);
  }

  /// Scenes call it before they are drawn.
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
