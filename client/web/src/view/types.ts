// What the parts of the view have in common.

/// Coordinates or a direction, in the units and the frame of the mesh's file.
export type Vec = [number, number, number];

/// A perspective camera.
export interface CameraState {
  eye: Vec;
  /// What it looks at and turns about.
  target: Vec;
  up: Vec;
  /// Vertical angle of view, degrees.
  fov: number;
}

/// A camera that points are sampled for, whatever the picture is seen from.
export interface FrozenCamera {
  camera: CameraState;
  /// Of its picture.
  aspect: number;
  /// There are points in its picture only: what of their discs reaches out of it is not drawn.
  isCut: boolean;
  /// They are even on its screen: discs on what it sees from the side are far too large from elsewhere.
  isEven: boolean;
}

/// A closed surface of discs, or the points alone.
export type Mode = "splats" | "dots";
/// What the colours tell; "colour" are the mesh's own. Where the points lack what is asked for, they are shaded.
export type Colouring = "shading" | "normal" | "curvature" | "rank" | "density" | "colour";
export type Background = "light" | "dark";

/// How points are drawn.
export interface Style {
  mode: Mode;
  colouring: Colouring;
  background: Background;
  /// Eye-dome lighting: edges in depth are darkened. Dots lie on a pale surface then.
  edl: boolean;
  /// Diameter of a dot, CSS pixels.
  dotSize: number;
  /// Times every radius.
  splatScale: number;
}

export const defaultStyle: Readonly<Style> = {
  mode: "splats",
  colouring: "shading",
  background: "light",
  edl: true,
  dotSize: 3,
  splatScale: 1,
};

/// A place on the surface under the pointer.
export interface Pick {
  point: Vec;
  /// Unit length.
  normal: Vec;
  /// Of the disc that is nearest.
  radius: number;
}

/// The browser has no WebGL2, or refuses it.
export class NoWebGL2Error extends Error {
  constructor() {
    super("The browser offers no WebGL 2.");
    this.name = "NoWebGL2Error";
  }
}
