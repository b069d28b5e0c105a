// SPDX-License-Identifier: Apache-2.0
// The entry curvecast/three: the points of a stream in any scene of three.js.

export { CurvecastPoints } from "../src/view/curvecast_points";
export {
  defaultStyle,
  type Background,
  type Colouring,
  type Mode,
  type PaintDab,
  type Section,
  type Style,
  type Vec,
} from "../src/view/types";
