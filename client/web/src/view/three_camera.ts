// A camera state as a camera of three.js.

import type * as THREE from "three";
import { clipPlanes, type Bounds } from "./camera_math";
import type { CameraState } from "./types";

/// Sets `drawn` to `camera`, for pictures of `aspect` (width over height) of a surface within `bounds`.
export function aim(drawn: THREE.PerspectiveCamera, camera: CameraState, bounds: Bounds, aspect: number): void {
  drawn.position.fromArray(camera.eye);
  drawn.up.fromArray(camera.up);
  drawn.lookAt(...camera.target);
  drawn.fov = camera.fov;
  drawn.aspect = aspect;
  Object.assign(drawn, clipPlanes(camera, bounds));
  drawn.updateProjectionMatrix();
  drawn.updateMatrixWorld();
}
