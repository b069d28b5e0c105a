// SPDX-License-Identifier: Apache-2.0
// Draws points: the viewer's picture, and an object for other scenes of three.js.

export { copyTo, type DrawOver } from "./canvas_copies";
export { CurvecastPoints } from "./curvecast_points";
export { defaultStyle, NoWebGL2Error } from "./types";
export type { Background, CameraState, Colouring, Mode, PaintDab, Pick, Section, Style, Vec } from "./types";
export { sectionOf } from "./section";
export { directionOf, upAxisOf } from "./standard_views";
export type { StandardView, UpAxis } from "./standard_views";
export { takesKeys } from "./keyboard_focus";
export type { Measured, MeasureKind } from "./measures";
export { Viewport } from "./viewport";
