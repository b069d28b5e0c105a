// SPDX-License-Identifier: Apache-2.0
// Moves a camera by pointer, wheel and keys. Left drag or one finger: orbit about what is under the pointer; right drag, shift or two
// fingers: pan; wheel or pinch: zoom to the pointer; double click: look there; arrows: orbit, with shift pan; + and -: zoom.
// Flying: W A S D Q E move, dragging looks around, shift is faster.

import { type Bounds, blend, boundsRadius, centre, farthestRadii, mayMove, orbit, shift, zoom } from "./camera_math";
import type { CameraState, Ray, Vec } from "./types";
import { takesKeys } from "./keyboard_focus";
import { along, distance, dot, subtract } from "./vector";

/// What the controls need of the viewport. Coordinates are CSS pixels of the canvas.
export interface ControlsHost {
  camera(): CameraState;
  moveTo(camera: CameraState): void;
  bounds(): Bounds;
  /// Returns the point of the surface at a pixel; null beside the surface.
  surfaceAt(x: number, y: number): Vec | null;
  rayAt(x: number, y: number): Ray;
  /// Has tick() called with the next frame.
  wake(): void;
}

/// A tool, which takes the left button or one finger instead of the camera.
export interface PointerTool {
  press(x: number, y: number): void;
  drag(x: number, y: number): void;
  release(): void;
}

type Gesture = "orbit" | "pan" | "look" | "tool" | "none";

const turnsPerHeight = 0.8;
const flyKeys = ["KeyW", "KeyA", "KeyS", "KeyD", "KeyQ", "KeyE"];
const arrows: Record<string, [number, number]> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

/// Moves the camera of a host. Listens to the canvas until dispose(), for keys to the window: the page is the picture's. A canvas within
/// a shadow tree is part of somebody else's page, and takes keys only while it has the focus.
export class CameraControls {
  navigation: "orbit" | "fly" = "orbit";
  tool: PointerTool | null = null;
  /// Is called for a press and a release at one point.
  onClick: ((x: number, y: number) => void) | null = null;
  /// Is called when the pointer moves, pressed or not, and with null when the pointer leaves.
  onHover: ((at: { x: number; y: number } | null) => void) | null = null;

  private readonly pointers = new Map<number, { x: number; y: number }>();
  private readonly keys = new Set<string>();
  private gesture: Gesture = "none";
  private pivot: Vec = [0, 0, 0];
  private pressed = { x: 0, y: 0, time: 0, moved: true };
  private flight: { from: CameraState; to: CameraState; begin: number } | null = null;
  private lastTick = 0;
  private readonly ended = new AbortController();

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly host: ControlsHost,
  ) {
    const { signal } = this.ended;
    canvas.style.touchAction = "none";
    if (canvas.tabIndex < 0) canvas.tabIndex = 0;
    canvas.addEventListener("pointerdown", (event) => this.press(event), { signal });
    canvas.addEventListener("pointermove", (event) => this.move(event), { signal });
    canvas.addEventListener("pointerup", (event) => this.release(event), { signal });
    canvas.addEventListener("pointercancel", (event) => this.release(event), { signal });
    canvas.addEventListener("pointerleave", () => this.onHover?.(null), { signal });
    canvas.addEventListener("wheel", (event) => this.wheel(event), { signal, passive: false });
    canvas.addEventListener("dblclick", (event) => this.lookAt(event), { signal });
    canvas.addEventListener("contextmenu", (event) => event.preventDefault(), { signal });
    // Keys on their way down: panels stop theirs on their way up.
    const pressed: GlobalEventHandlers = canvas.getRootNode() instanceof ShadowRoot ? canvas : window;
    pressed.addEventListener("keydown", (event) => this.keyDown(event), { signal, capture: true });
    pressed.addEventListener("keyup", (event) => this.keys.delete(event.code), { signal, capture: true });
    window.addEventListener("blur", () => this.keys.clear(), { signal });
  }

  /// Moves the camera to another one within a third of a second.
  flyTo(to: CameraState): void {
    this.flight = { from: this.host.camera(), to, begin: performance.now() };
    this.host.wake();
  }

  /// Ends a flight: the camera stays where it is.
  stop(): void {
    this.flight = null;
  }

  /// Moves the camera on to a time in milliseconds. Returns whether it goes on moving.
  tick(now: number): boolean {
    const seconds = Math.min((now - this.lastTick) / 1000, 0.1);
    this.lastTick = now;
    if (this.flight) {
      const t = Math.min(1, Math.max(0, (now - this.flight.begin) / 320));
      this.host.moveTo(blend(this.flight.from, this.flight.to, t * t * (3 - 2 * t)));
      if (t >= 1) this.flight = null;
    }
    const moves = this.navigation === "fly" && flyKeys.some((key) => this.keys.has(key));
    if (moves) this.fly(seconds);
    return moves || this.flight !== null;
  }

  dispose(): void {
    this.ended.abort();
  }

  private at(event: MouseEvent): { x: number; y: number } {
    const box = this.canvas.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  }

  /// Returns the point of the surface at a pixel, or beside the surface the point as far away as the target.
  private grab(x: number, y: number): Vec {
    const ray = this.host.rayAt(x, y);
    const camera = this.host.camera();
    const isParallel = camera.orthographic === true;
    const reach = isParallel ? dot(subtract(camera.target, ray.origin), ray.direction) : distance(camera.eye, camera.target);
    return this.host.surfaceAt(x, y) ?? along(ray.origin, ray.direction, reach);
  }

  private press(event: PointerEvent): void {
    const at = this.at(event);
    this.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, at);
    this.stop();
    if (this.gesture === "tool") this.tool?.release();
    this.pressed = { ...at, time: event.timeStamp, moved: this.pointers.size > 1 || event.button !== 0 };
    if (this.pointers.size > 1) {
      this.gesture = "pan";
      this.pivot = this.grab(this.middle().x, this.middle().y);
    } else if (event.button !== 0 || event.shiftKey) {
      this.gesture = "pan";
      this.pivot = this.grab(at.x, at.y);
    } else if (this.tool) {
      this.gesture = "tool";
      this.tool.press(at.x, at.y);
    } else if (this.navigation === "fly") {
      this.gesture = "look";
    } else {
      this.gesture = "orbit";
      this.pivot = this.host.surfaceAt(at.x, at.y) ?? this.host.camera().target;
    }
  }

  private middle(): { x: number; y: number; spread: number } {
    const all = [...this.pointers.values()];
    const x = all.reduce((sum, p) => sum + p.x, 0) / all.length;
    const y = all.reduce((sum, p) => sum + p.y, 0) / all.length;
    return { x, y, spread: all.reduce((sum, p) => sum + Math.hypot(p.x - x, p.y - y), 0) / all.length };
  }

  private move(event: PointerEvent): void {
    const at = this.at(event);
    this.onHover?.(at);
    if (!this.pointers.has(event.pointerId)) return;
    const before = this.middle();
    this.pointers.set(event.pointerId, at);
    const now = this.middle();
    if (Math.hypot(at.x - this.pressed.x, at.y - this.pressed.y) > 4) this.pressed.moved = true;
    const { host } = this;
    const height = this.canvas.clientHeight || 1;
    const turn = (2 * Math.PI * turnsPerHeight) / height;
    const [dx, dy] = [now.x - before.x, now.y - before.y];
    if (this.gesture === "tool") {
      this.tool?.drag(at.x, at.y);
    } else if (this.gesture === "orbit") {
      host.moveTo(orbit(host.camera(), this.pivot, -dx * turn, -dy * turn));
    } else if (this.gesture === "look") {
      host.moveTo(orbit(host.camera(), host.camera().eye, -dx * turn * 0.5, -dy * turn * 0.5));
    } else if (this.gesture === "pan") {
      this.pan(dx, dy);
      if (this.pointers.size > 1 && before.spread > 8 && now.spread > 8) this.zoomTo(this.pivot, before.spread / now.spread);
    }
  }

  /// Shifts the camera so that the grabbed point stays under the pointer.
  private pan(dx: number, dy: number): void {
    const camera = this.host.camera();
    const forward = subtract(camera.target, camera.eye);
    const pivot = camera.orthographic === true ? camera.target : this.pivot;
    const depth = dot(subtract(pivot, camera.eye), forward) / distance(camera.target, camera.eye);
    const perPixel = (2 * Math.tan((camera.fov * Math.PI) / 360) * Math.max(depth, 0)) / (this.canvas.clientHeight || 1);
    this.host.moveTo(shift(camera, -dx * perPixel, dy * perPixel, 0));
  }

  private release(event: PointerEvent): void {
    if (!this.pointers.delete(event.pointerId)) return;
    if (this.gesture === "tool") {
      this.tool?.release();
    } else if (!this.pressed.moved && event.type === "pointerup" && event.timeStamp - this.pressed.time < 500) {
      this.onClick?.(this.pressed.x, this.pressed.y);
    }
    // The finger that is left of two goes on panning.
    this.gesture = this.pointers.size > 0 ? "pan" : "none";
  }

  private zoomTo(point: Vec, factor: number): void {
    const { host } = this;
    const radius = boundsRadius(host.bounds());
    host.moveTo(zoom(host.camera(), point, factor, 1e-4 * radius, farthestRadii * radius));
  }

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    this.stop();
    const unit = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 30 : event.deltaMode === WheelEvent.DOM_DELTA_PAGE ? 300 : 1;
    // Browsers send a pinch on a trackpad as a wheel with the control key.
    const steps = Math.min(300, Math.max(-300, event.deltaY * unit * (event.ctrlKey ? 8 : 1)));
    const { x, y } = this.at(event);
    this.zoomTo(this.grab(x, y), Math.exp(steps * 0.0015));
  }

  private lookAt(event: MouseEvent): void {
    if (this.tool) return;
    const { x, y } = this.at(event);
    const point = this.host.surfaceAt(x, y);
    if (point) this.flyTo(centre(this.host.camera(), point));
  }

  private keyDown(event: KeyboardEvent): void {
    if (takesKeys(event.target) || event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
    const arrow = arrows[event.key];
    if (arrow) {
      this.stop();
      const step = (4 * Math.PI) / 180;
      const { host } = this;
      if (event.shiftKey) {
        this.pivot = host.camera().target;
        this.pan(-30 * arrow[0], 30 * arrow[1]);
      } else {
        const pivot = this.navigation === "fly" ? host.camera().eye : host.camera().target;
        const side = this.navigation === "fly" ? -1 : 1;
        host.moveTo(orbit(host.camera(), pivot, side * step * arrow[0], -side * step * arrow[1]));
      }
    } else if (event.key === "+" || event.key === "=" || event.key === "-") {
      this.stop();
      this.zoomTo(this.host.camera().target, event.key === "-" ? 1.15 : 1 / 1.15);
    } else if (this.navigation === "fly" && flyKeys.includes(event.code)) {
      this.keys.add(event.code);
      if (!event.repeat) this.lastTick = performance.now();
      this.host.wake();
    } else {
      if (event.key === "Shift") this.keys.add(event.code);
      return;
    }
    event.preventDefault();
  }

  private fly(seconds: number): void {
    const { host, keys } = this;
    const radius = boundsRadius(host.bounds());
    const axis = (plus: string, minus: string): number => Number(keys.has(plus)) - Number(keys.has(minus));
    const isFast = keys.has("ShiftLeft") || keys.has("ShiftRight");
    const pace = 0.5 * (isFast ? 4 : 1) * seconds;
    const step = radius * pace;
    const ahead = axis("KeyW", "KeyS");
    if (host.camera().orthographic === true && ahead !== 0) this.zoomTo(host.camera().target, Math.exp(-pace * ahead)); // nothing comes nearer
    const moved = shift(host.camera(), step * axis("KeyD", "KeyA"), step * axis("KeyE", "KeyQ"), step * ahead);
    if (mayMove(host.camera().eye, moved.eye, host.bounds())) host.moveTo(moved);
  }
}
