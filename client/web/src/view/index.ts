// Draws points: the viewer's picture, and an object for other scenes of three.js.

export { CurvecastPoints } from "./curvecast_points";
export { defaultStyle, NoWebGL2Error } from "./types";
export type { Background, CameraState, Colouring, Mode, Pick, Style, Vec } from "./types";
export { takesKeys } from "./keyboard_focus";
export { Viewport } from "./viewport";
