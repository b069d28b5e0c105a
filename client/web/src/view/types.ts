// SPDX-License-Identifier: Apache-2.0
// The types that the parts of the view share.

/// Coordinates or a direction, in the units and the frame of the mesh's file.
export type Vec = [number, number, number];

/// A camera.
export interface CameraState {
  eye: Vec;
  /// The point that the camera looks at and turns about.
  target: Vec;
  up: Vec;
  /// Vertical angle of view, degrees.
  fov: number;
  /// Its rays are parallel, and go on behind the eye. What is at the target is as large as without.
  orthographic?: boolean;
}

/// A ray from the eye.
export interface Ray {
  origin: Vec;
  /// Unit length.
  direction: Vec;
  /// The rays of the picture are parallel.
  isParallel?: boolean;
}

/// A camera that points are sampled for, while the picture may be seen from elsewhere.
export interface FrozenCamera {
  camera: CameraState;
  /// Width over height of its picture.
  aspect: number;
  /// Points lie in its picture only: the parts of discs that reach out of it are not drawn.
  isCut: boolean;
  /// Points are even on its screen: discs that it sees from the side are far too large from elsewhere, and are drawn slimmer.
  isEven: boolean;
}

/// A closed surface of discs, the points alone, or the surface's own triangles: discs until these are there.
export type Mode = "splats" | "dots" | "mesh";
/// What the colours show; "colour": those of the mesh. Points without the values that a colouring needs are shaded.
export type Colouring = "shading" | "normal" | "curvature" | "rank" | "density" | "colour";
export type Background = "light" | "dark";

/// A ball of paint: points within `radius` of the centre have `factor` times the density.
export interface PaintDab {
  centre: Vec;
  radius: number;
  factor: number;
}

/// A plane that cuts the surface open: only where normal · x <= offset is it drawn and picked.
export interface Section {
  normal: Vec;
  offset: number;
}

/// How points are drawn.
export interface Style {
  mode: Mode;
  colouring: Colouring;
  background: Background;
  /// Eye-dome lighting, which darkens edges in depth. Dots then lie on a pale surface.
  edl: boolean;
  /// Diameter of a dot, CSS pixels.
  dotSize: number;
  /// Factor of every radius.
  splatScale: number;
  /// Shows on the surface's own colours, and on clay. The later ones are on top.
  paint: readonly PaintDab[];
  /// null: the surface is whole.
  section: Section | null;
}

export const defaultStyle: Readonly<Style> = {
  mode: "splats",
  colouring: "shading",
  background: "light",
  edl: true,
  dotSize: 3,
  splatScale: 1,
  paint: [],
  section: null,
};

/// The point of the surface under the pointer.
export interface Pick {
  point: Vec;
  /// Unit length.
  normal: Vec;
  /// Radius of the nearest disc.
  radius: number;
}

/// The error of a browser that has no WebGL 2, or refuses it.
export class NoWebGL2Error extends Error {
  constructor() {
    super("The browser offers no WebGL 2.");
    this.name = "NoWebGL2Error";
  }
}
