// SPDX-License-Identifier: Apache-2.0
// A picture: what is drawn, and its colours.

import * as THREE from "three";
import type { DiscShape, PointsGeometry } from "./points_geometry";
import type { SurfaceGeometry } from "./surface_geometry";
import type { AimedCamera } from "./three_camera";
import type { Background, Style } from "./types";

interface Look {
  top: THREE.Color;
  bottom: THREE.Color;
  clay: THREE.Color;
  back: THREE.Color;
  /// The surface under dots.
  pale: THREE.Color;
  dots: THREE.Color;
}

const colour = (hex: number): THREE.Color => new THREE.Color(hex);
export const looks: Record<Background, Look> = {
  light: {
    top: colour(0xfafbfc),
    bottom: colour(0xcdd3db),
    clay: colour(0xd2b79f),
    back: colour(0x7d8797),
    pale: colour(0xe9e7e3),
    dots: colour(0x141822).convertLinearToSRGB(),
  },
  dark: {
    top: colour(0x2b3038),
    bottom: colour(0x121418),
    clay: colour(0xd2b79f),
    back: colour(0x6b7688),
    pale: colour(0x3d434d),
    dots: colour(0xf0ead8).convertLinearToSRGB(),
  },
};

/// Where a picture is on the canvas, in pixels of the canvas, from its lower left corner.
export interface Rectangle {
  x: number;
  y: number;
  width: number;
  height: number;
}

/// All that a picture shows.
export interface Picture {
  points: PointsGeometry | null;
  /// Drawn instead of the points.
  surface: SurfaceGeometry | null;
  style: Style;
  camera: AimedCamera;
  where: Rectangle;
  /// Pixels of the canvas per CSS pixel.
  pixelRatio: number;
  /// Drawn soon rather than finely.
  isQuick: boolean;
  /// Half the diagonal of the surface's box.
  sceneRadius: number;
  brush: { centre: THREE.Vector3; radius: number } | null;
  /// The camera that the points are for, where that is not the picture's. The rest as in FrozenCamera.
  frozen: { camera: AimedCamera; isCut: boolean; isEven: boolean } | null;
}

/// A way to draw pictures.
export interface Passes {
  /// The shape that the geometry of the points must have.
  readonly shape: DiscShape;
  /// Whether surfaces are drawn, too.
  readonly drawsSurfaces: boolean;
  /// The depths of the surface in the picture drawn last; null where they are not kept.
  readonly depths: THREE.Texture | null;
  render(picture: Picture): void;
  dispose(): void;
}
