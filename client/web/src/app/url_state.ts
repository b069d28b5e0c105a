// SPDX-License-Identifier: Apache-2.0
// Reads and writes the part of the page's address after #: the session, the camera, and settings that differ from the defaults.

import { isUsable } from "../view/camera_math";
import type { CameraState } from "../view";
import { maxMarks, readMark, writeMark } from "./marks/mark";
import { ranges, withinRange, type Dab, type Settings } from "./settings";

/// What an address says. All parts are optional.
export interface UrlState {
  session: string | null;
  camera: CameraState | null;
  settings: Partial<Settings>;
}

const mostDabs = 500; // longer addresses are too much for browsers and for those who pass them on
const digits = 12; // of a number: coordinates may lie far from 0, and cameras near the surface
// Settings that are written even where they are the defaults, because these differ from machine to machine.
const always: readonly (keyof Settings)[] = ["points", "background"];
// Settings of what a visit does, not of how the page looks; and the angle of view, which the camera has.
const unsaved: readonly (keyof Settings)[] = ["dabs", "brush", "eraser", "measuring", "marks", "marking", "frozen", "fieldOfView"];

const choices: { [Key in keyof Settings]?: readonly string[] } = {
  budget: ["points", "bytes", "pixels", "automatic"],
  sampler: ["progressive", "equalised"],
  sequence: ["jittered", "regular", "vanDerCorput", "goldenRatio"],
  curvature: ["none", "gauss", "mean", "max"],
  mode: ["splats", "dots", "mesh"],
  colouring: ["shading", "normal", "curvature", "rank", "density", "colour"],
  background: ["light", "dark"],
  section: ["none", "x", "y", "z"],
  up: ["y", "z"],
  projection: ["perspective", "orthographic"],
  navigation: ["orbit", "fly"],
  measure: ["distance", "angle", "area"],
  unit: ["none", "mm", "cm", "m", "in", "ft"],
};

function numbers(text: string, count: number): number[] | null {
  const values = text.split(",").map(Number);
  return values.length === count && values.every(Number.isFinite) ? values : null;
}

/// Returns the shortest text of a number that keeps its digits.
function short(value: number): string {
  return String(Number(value.toPrecision(digits)));
}

function readCamera(text: string): CameraState | null {
  const v = numbers(text, 10);
  if (v === null) return null;
  const [ex, ey, ez, tx, ty, tz, ux, uy, uz, fov] = v as [
    number,
    number,
    number,
    number,
    number,
    number,
    number,
    number,
    number,
    number,
  ];
  const camera: CameraState = { eye: [ex, ey, ez], target: [tx, ty, tz], up: [ux, uy, uz], fov };
  return isUsable(camera) ? camera : null;
}

/// Strokes: radius, factor and the places of all dabs.
function writeDabs(dabs: readonly Dab[]): string {
  const strokes = new Map<number, number[]>();
  for (const { centre, radius, factor, stroke } of dabs) {
    if (!strokes.has(stroke)) strokes.set(stroke, [radius, factor]);
    strokes.get(stroke)!.push(...centre);
  }
  return [...strokes.values()].map((values) => values.map(short).join(",")).join(";");
}

function readDabs(text: string): Dab[] {
  return text.split(";").flatMap((part, stroke) => {
    const v = part.split(",").map(Number);
    const [radius, factor, ...centres] = v as [number, number, ...number[]];
    if (v.length < 5 || v.length % 3 !== 2 || !v.every(Number.isFinite) || radius <= 0 || factor < 0) return [];
    const dabs: Dab[] = [];
    for (let i = 0; i < centres.length; i += 3) {
      const centre = centres.slice(i, i + 3) as Dab["centre"];
      dabs.push({ centre, radius, factor: withinRange("brushFactor", factor), stroke });
    }
    return dabs;
  });
}

function readSetting(key: keyof Settings, text: string, like: unknown): unknown {
  if (typeof like === "boolean") return text === "1" ? true : text === "0" ? false : undefined;
  if (key in ranges) {
    const value = text.trim() === "" ? NaN : Number(text);
    return Number.isFinite(value) ? withinRange(key as keyof typeof ranges, value) : undefined;
  }
  return choices[key]?.includes(text) === true ? text : undefined;
}

/// Reads an address, and leaves out what cannot be understood. `defaults`: all settings that there are.
export function readState(hash: string, defaults: Settings): UrlState {
  const given = new URLSearchParams(hash.replace(/^#/, ""));
  const settings: Record<string, unknown> = {};
  for (const [key, like] of Object.entries(defaults) as [keyof Settings, unknown][]) {
    const text = given.get(key);
    const value = text === null || unsaved.includes(key) ? undefined : readSetting(key, text, like);
    if (value !== undefined) settings[key] = value;
  }
  const dabs = given.get("dabs");
  if (dabs !== null) settings.dabs = readDabs(dabs);
  const marks = given.getAll("mark").flatMap((written) => readMark(written) ?? []);
  if (marks.length > 0) settings.marks = marks.slice(0, maxMarks);
  const camera = readCamera(given.get("camera") ?? "");
  if (camera !== null && settings.projection === "orthographic") camera.orthographic = true;
  return { session: given.get("session"), camera, settings };
}

/// Writes an address that readState() reads, # included.
export function writeState(session: string | null, camera: CameraState | null, settings: Settings, defaults: Settings): string {
  const out = new URLSearchParams();
  if (session !== null) out.set("session", session);
  if (camera !== null) out.set("camera", [...camera.eye, ...camera.target, ...camera.up, camera.fov].map(short).join(","));
  for (const key of Object.keys(defaults) as (keyof Settings)[]) {
    const value = settings[key];
    if (typeof value === "object" || unsaved.includes(key) || (value === defaults[key] && !always.includes(key))) continue;
    out.set(key, typeof value === "boolean" ? (value ? "1" : "0") : typeof value === "number" ? short(value) : value);
  }
  if (settings.dabs.length > 0 && settings.dabs.length <= mostDabs) out.set("dabs", writeDabs(settings.dabs));
  for (const mark of settings.marks) out.append("mark", writeMark(mark, short));
  return "#" + out.toString().replaceAll("%2C", ",").replaceAll("%3B", ";");
}
