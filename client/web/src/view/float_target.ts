// SPDX-License-Identifier: Apache-2.0
// Where passes draw what is shaded later: sums in floating point, and depths that can be read.

import * as THREE from "three";

/// Makes a target of so many textures with so many samples a pixel, 0 for one. Precondition: canBlend().
export function makeFloatTarget(width: number, height: number, count: number, samples = 0): THREE.WebGLRenderTarget {
  const nearest = { minFilter: THREE.NearestFilter, magFilter: THREE.NearestFilter } as const;
  const target = new THREE.WebGLRenderTarget(width, height, { count, samples, type: THREE.HalfFloatType, ...nearest });
  target.depthTexture = new THREE.DepthTexture(width, height, THREE.FloatType);
  return target;
}

/// Gives back what a target has on the graphics card.
export function dropFloatTarget(target: THREE.WebGLRenderTarget | null): void {
  target?.depthTexture?.dispose();
  target?.dispose();
}
