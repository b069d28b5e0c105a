// SPDX-License-Identifier: Apache-2.0
// What settings mean for the picture.

import { sectionOf, type Mode, type PaintDab, type Section, type Style, type Viewport } from "../view";
import { distance } from "../view/vector";
import type { Settings } from "./settings";

type Bounds = Viewport["bounds"];

const noPaint: readonly PaintDab[] = [];

/// The brush's radius in units.
export const brushRadiusOf = ({ brushSize }: Settings, { min, max }: Bounds): number => (brushSize / 100) * distance(min, max);

function sectionIn({ section, sectionShare, sectionOther }: Settings, bounds: Bounds): Section | null {
  return section === "none" ? null : sectionOf(section, sectionShare / 100, sectionOther, bounds);
}

/// How the picture is drawn. `mode`: what is drawn at the moment. `painted` returns what the brush has painted.
export function styleOf(settings: Settings, mode: Mode, painted: () => readonly PaintDab[], bounds: Bounds): Style {
  const { colouring, background, edl, dotSize, splatScale } = settings;
  const paint = settings.brush && mode === "splats" ? painted() : noPaint;
  return { mode, colouring, background, edl, dotSize, splatScale, paint, section: sectionIn(settings, bounds) };
}

/// Sets what the camera and the canvas have of the settings.
export function applyView(settings: Settings, viewport: Viewport): void {
  viewport.setUp(settings.up);
  viewport.setFieldOfView(settings.fieldOfView);
  viewport.setOrthographic(settings.projection === "orthographic");
  viewport.maxPixelRatio = settings.pixelRatio;
  viewport.navigation = settings.navigation;
}
