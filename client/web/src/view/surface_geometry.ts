// SPDX-License-Identifier: Apache-2.0
// Keeps the surface's own triangles on the graphics card.

import * as THREE from "three";
import type { SurfaceMesh } from "../stream/decoded_surface";

/// A surface on the graphics card.
export class SurfaceGeometry {
  readonly triangles = new THREE.BufferGeometry();

  constructor(readonly mesh: SurfaceMesh) {
    this.triangles.setIndex(new THREE.BufferAttribute(mesh.triangles, 1));
    this.triangles.setAttribute("position", new THREE.BufferAttribute(mesh.positions, 3));
    this.triangles.setAttribute("normal", new THREE.BufferAttribute(mesh.normals, 3));
    if (mesh.colours) this.triangles.setAttribute("colour", new THREE.BufferAttribute(mesh.colours, 3, true));
  }

  /// Drawing it makes anew what this gives back.
  dispose(): void {
    this.triangles.dispose();
  }
}
