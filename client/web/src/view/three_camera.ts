// SPDX-License-Identifier: Apache-2.0
// A camera state as a camera of three.js.

import * as THREE from "three";
import { clipPlanes, halfHeight, standpoint, type Bounds } from "./camera_math";
import type { CameraState } from "./types";
import { along, subtract } from "./vector";

/// A camera that aim() has aimed.
export class AimedCamera extends THREE.Camera {
  near = 1;
  far = 2;
  isParallel = false; // orthographic

  /// Half the width and half the height of the picture: at distance 1 from the eye, or anywhere where rays are parallel.
  get halfSize(): [number, number] {
    const { elements } = this.projectionMatrix;
    return [1 / elements[0], 1 / elements[5]];
  }
}

/// Sets `drawn` to `camera`, for pictures of `aspect` (width over height) of a surface within `bounds`.
export function aim(drawn: AimedCamera, camera: CameraState, bounds: Bounds, aspect: number): void {
  const { near, far } = clipPlanes(camera, bounds);
  const isParallel = camera.orthographic === true;
  const from = standpoint(camera, bounds);
  const top = isParallel ? halfHeight(camera) : near * Math.tan((camera.fov * Math.PI) / 360);
  const side = top * aspect;
  Object.assign(drawn, { near, far, isParallel });
  drawn.position.fromArray(from);
  drawn.up.fromArray(camera.up);
  drawn.lookAt(...along(from, subtract(camera.target, camera.eye), 1));
  if (isParallel) drawn.projectionMatrix.makeOrthographic(-side, side, top, -top, near, far);
  else drawn.projectionMatrix.makePerspective(-side, side, top, -top, near, far);
  drawn.projectionMatrixInverse.copy(drawn.projectionMatrix).invert();
  drawn.updateMatrixWorld();
}
