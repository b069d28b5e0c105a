// SPDX-License-Identifier: Apache-2.0
// The viewer's picture: the points of one or two stores, the lines over them, and the pointer's tools.

import * as THREE from "three";
import type { PointStore } from "../stream/point_store";
import type { SurfaceMesh } from "../stream/decoded_surface";
import type { TriangleMesh } from "../stream/triangle_mesh";
import { BrushTool } from "./brush_tool";
import { CanvasPixels } from "./canvas_pixels";
import { CameraControls } from "./camera_controls";
import { type Bounds, centre, fit, isUsable } from "./camera_math";
import { Drawing } from "./drawing";
import { DrawingWatch } from "./drawing_watch";
import { type Detail, type Drawn, fine, FrameClock } from "./frame_clock";
import { MeasureTool } from "./measure_tool";
import type { Measured, MeasureKind } from "./measures";
import type { OverlayLine } from "./overlay_lines";
import { frustumLines, markDots } from "./overlay_shapes";
import { PicturePlaces, type Shown } from "./picture_places";
import { pngOf, shrunk, type DrawOver } from "./canvas_copies";
import { firstCamera, lookFrom, type UpAxis, withFieldOfView, withUp } from "./standard_views";
import { type CameraState, defaultStyle, type FrozenCamera, type Pick, type Style, type Vec } from "./types";
import { openContext } from "./webgl_context";

const longestHold = 120; // ms that a picture waits for its points, where the processor draws

/// Draws on a canvas. Draws on demand, when something has changed, and on slow machines with fewer pixels and points while it changes.
export class Viewport {
  /// Is called when the camera has moved, by the user or by the page.
  onCamera: (() => void) | null = null;
  /// Is called when the brush paints at `centre`. `done`: the stroke ends there.
  onBrush: ((centre: Vec, done: boolean) => void) | null = null;
  /// Is called with what clicked points measure, and with null once there is nothing.
  onMeasure: ((measured: Measured | null) => void) | null = null;
  /// Is called with a point of the surface that is clicked.
  onClick: ((point: Vec) => void) | null = null;
  /// Is called when the graphics card is lost, and with false when it is back.
  onLost: ((isLost: boolean) => void) | null = null;
  /// Is called when the pictures have got other sizes.
  onResize: (() => void) | null = null;
  /// Is called when the processor has drawn: isDrawing is false again.
  onDrawn: (() => void) | null = null;
  /// Is called with what a picture that was drawn has: points, and the milliseconds that they took.
  onPicture: ((picture: { points: number; milliseconds: number; isFine: boolean }) => void) | null = null;
  /// Whether the processor draws, for want of a graphics card.
  readonly isSoftware: boolean;

  private readonly renderer: THREE.WebGLRenderer;
  private readonly drawing: Drawing;
  private readonly clock: FrameClock;
  private readonly watch: DrawingWatch;
  private readonly controls: CameraControls;
  private readonly measuring = new MeasureTool((measured) => this.onMeasure?.(measured));
  private readonly brush = new BrushTool(
    (x, y) => this.pick(x, y)?.point ?? null,
    (centre, done) => this.onBrush?.(centre, done),
  );
  private readonly pixels: CanvasPixels;
  private readonly places: PicturePlaces;
  private readonly ended = new AbortController();
  private stores: (PointStore | null)[] = [null];
  private surface: SurfaceMesh | null = null;
  private styleNow: Style = { ...defaultStyle };
  private cameraNow: CameraState = { ...firstCamera };
  private boundsNow: Bounds = { min: [-1, -1, -1], max: [1, 1, 1] };
  private frozen: FrozenCamera | null = null;
  private marks: readonly Vec[] = [];
  private hover: { x: number; y: number } | null = null;
  private hovered: Pick | null = null;
  private isLost = false;

  /// Throws NoWebGL2Error.
  constructor(private readonly canvas: HTMLCanvasElement) {
    const { context, isSoftware } = openContext(canvas);
    this.isSoftware = isSoftware;
    this.renderer = new THREE.WebGLRenderer({ canvas, context });
    this.renderer.autoClear = false;
    this.drawing = new Drawing(this.renderer, () => this.invalidate());
    this.clock = new FrameClock((now, detail) => this.drawFrame(now, detail), this.isSoftware);
    this.watch = new DrawingWatch(context, () => this.hasDrawn());
    this.controls = new CameraControls(canvas, {
      camera: () => this.cameraNow,
      moveTo: (camera) => this.moveTo(camera),
      bounds: () => this.boundsNow,
      surfaceAt: (x, y) => this.pick(x, y)?.point ?? null,
      rayAt: (x, y) => this.places.rayAt(x, y),
      wake: () => this.clock.invalidate(true),
    });
    this.controls.onClick = (x, y) => this.click(x, y);
    this.controls.onHover = (at) => this.hoverAt(at);
    const shown = (): Shown => ({
      stores: this.stores,
      surface: this.surface,
      camera: this.cameraNow,
      bounds: this.boundsNow,
      style: this.styleNow,
    });
    this.places = new PicturePlaces(canvas, shown);
    this.pixels = new CanvasPixels(canvas, () => (this.invalidate(), this.onResize?.()));
    const { signal } = this.ended;
    canvas.addEventListener("webglcontextlost", () => this.lose(true), { signal });
    canvas.addEventListener("webglcontextrestored", () => this.lose(false), { signal });
    this.invalidate();
  }

  /// Shows one store, or two side by side, seen by the same camera. The viewport is the reader of their changes.
  setStores(left: PointStore | null, right?: PointStore | null): void {
    this.stores = right === undefined ? [left] : [left, right];
    this.drawing.setStores(this.stores);
    this.invalidate();
  }

  /// Whether the graphics card can draw surfaces.
  get drawsSurfaces(): boolean {
    return this.drawing.drawsSurfaces;
  }

  /// Shows the surface's own triangles instead of the last store where the style's mode is "mesh"; null: there are none. Precondition:
  /// drawsSurfaces.
  setSurface(mesh: SurfaceMesh | null): void {
    this.surface = mesh;
    this.drawing.setSurface(mesh);
    this.invalidate();
  }

  /// Draws the edges of a mesh over the picture of the last store; null: none.
  setWireframe(mesh: TriangleMesh | null): void {
    this.drawing.setWireframe(mesh);
    this.invalidate();
  }

  set style(style: Style) {
    this.styleNow = style;
    this.invalidate();
  }

  get camera(): CameraState {
    return this.cameraNow;
  }

  /// Ignores a camera that cannot be drawn with.
  set camera(camera: CameraState) {
    this.controls.stop();
    this.moveTo(camera);
  }

  set navigation(navigation: "orbit" | "fly") {
    this.controls.navigation = navigation;
  }

  /// Sets the most pixels per CSS pixel.
  set maxPixelRatio(ratio: number) {
    this.pixels.maxRatio = ratio;
    this.invalidate();
  }

  /// Frames a second while something moves; 0 where nothing has moved for a second.
  get framesPerSecond(): number {
    return this.clock.framesPerSecond;
  }

  /// Size of one picture in device pixels. In a split view a picture is half of the canvas.
  get size(): { width: number; height: number } {
    return this.pixels.size(this.pixelRatio(1), this.stores.length);
  }

  /// Size of the canvas in CSS pixels.
  get cssSize(): { width: number; height: number } {
    return this.places.size;
  }

  /// Counts of the objects on the graphics card.
  get resources(): { geometries: number; textures: number; programs: number } {
    const { memory, programs } = this.renderer.info;
    return { geometries: memory.geometries, textures: memory.textures, programs: programs?.length ?? 0 };
  }

  /// The corners of the surface's box.
  get bounds(): Bounds {
    return this.boundsNow;
  }

  setBounds(min: Vec, max: Vec): void {
    this.boundsNow = { min: [...min], max: [...max] };
    this.invalidate();
  }

  /// Shows the whole surface, from the side that the camera is on.
  frame(): void {
    this.camera = this.framed(this.cameraNow);
  }

  /// Flies to where the whole surface is seen from a side: `direction` is the one from the surface to the eye.
  lookFrom(direction: Vec, up: UpAxis): void {
    this.controls.flyTo(this.framed(lookFrom(this.cameraNow, direction, up)));
  }

  /// Has an axis point up, and shows the whole surface where that was another one.
  setUp(up: UpAxis): void {
    const turned = withUp(this.cameraNow, up);
    if (turned !== this.cameraNow) this.camera = this.framed(turned);
  }

  /// Sets the vertical angle of view in degrees. What the camera looks at stays as large.
  setFieldOfView(degrees: number): void {
    if (degrees !== this.cameraNow.fov) this.camera = withFieldOfView(this.cameraNow, degrees);
  }

  /// Has the rays be parallel, or meet in the eye. What the camera looks at stays as large.
  setOrthographic(orthographic: boolean): void {
    if (orthographic !== (this.cameraNow.orthographic ?? false)) this.camera = { ...this.cameraNow, orthographic };
  }

  /// Sets the camera that points are sampled for, whose frustum is drawn; null: the picture's own.
  set frozenCamera(frozen: FrozenCamera | null) {
    this.frozen = frozen;
    this.invalidate();
  }

  /// Finds the surface, or the nearest visible point, at a point of the canvas in CSS pixels.
  pick(x: number, y: number): Pick | null {
    return this.places.pick(x, y);
  }

  /// Returns where a point is in the last of the pictures, in CSS pixels of the canvas; null where it is beside it.
  placeOf(point: Vec): { x: number; y: number } | null {
    return this.places.placeOf(point);
  }

  /// Aims the camera at a point, from the same side and distance.
  lookAt(point: Vec): void {
    this.controls.flyTo(centre(this.cameraNow, point));
  }

  /// Marks places by dots.
  setMarks(places: readonly Vec[]): void {
    this.marks = places;
    this.invalidate();
  }

  /// Lets the pointer paint with a radius in units, instead of turning the picture; null ends that.
  setBrush(radius: number | null): void {
    this.brush.radius = radius;
    this.controls.tool = radius === null ? null : this.brush;
    this.hoverAt(this.hover);
  }

  /// Switches the tool on that measures what is clicked; null: off.
  setMeasuring(kind: MeasureKind | null): void {
    if (this.measuring.setKind(kind)) this.invalidate();
  }

  /// Forgets the points that were clicked.
  forgetMeasured(): void {
    this.measuring.clear();
    this.invalidate();
  }

  invalidate(): void {
    this.clock.invalidate(false);
  }

  /// Whether the processor draws, or is about to. All other work would take its time until onDrawn. Always false with a graphics card.
  get isDrawing(): boolean {
    return this.isSoftware && (this.watch.isDrawing || this.clock.isDue);
  }

  /// Expects points for this camera. Where the processor draws, drawing waits for them for so many milliseconds, and leaves the
  /// processor's time to the server.
  expectPoints(longest = longestHold): void {
    if (this.isSoftware) this.clock.hold(longest);
  }

  /// Expects no points any more: those that came have changed nothing. Draws the picture that waited for them.
  expectNoPoints(): void {
    this.clock.release();
  }

  /// Draws a frame soon, because points of the stores have changed.
  pointsChanged(): void {
    this.clock.release();
    this.clock.invalidate(true);
  }

  /// Uploads the stores' changes to the graphics card now, instead of with the next frame. Returns the milliseconds that it took. Does
  /// nothing while the graphics card is lost.
  uploadNow(): number {
    if (this.isLost) return 0;
    const begin = performance.now();
    this.drawing.upload(this.styleNow);
    this.pointsChanged();
    return performance.now() - begin;
  }

  /// Returns the picture as a PNG, with all its points, and `scale` times as many pixels in each direction as on the page, or as many as
  /// the graphics card draws, and what `over` draws on it. Rejects while the graphics card is lost.
  screenshot(scale = 1, over?: DrawOver): Promise<Blob> {
    if (this.isLost) return Promise.reject(new Error("The graphics card was lost."));
    const { width, height } = this.size;
    const largest = this.renderer.capabilities.maxTextureSize / Math.max(width * this.stores.length, height);
    return pngOf(this.still(Math.min(scale, largest)), this.cssSize.width, over);
  }

  /// Draws the picture with all its points. Returns the canvas, which has it until the caller's task ends.
  still(scale = 1): HTMLCanvasElement {
    this.drawing.completeEnds(this.styleNow);
    this.render({ ...fine, scale });
    this.invalidate(); // the canvas has another size now
    return this.canvas;
  }

  /// Returns the picture at a small size, cut to its form, as a data URL; null while the graphics card is lost.
  thumbnail(width: number, height: number): string | null {
    if (this.isLost) return null;
    const scale = Math.min(1, Math.max((2 * width) / this.size.width, (2 * height) / this.size.height));
    return shrunk(this.still(scale), width, height);
  }

  dispose(): void {
    this.ended.abort();
    this.pixels.dispose();
    this.controls.dispose();
    this.setStores(null);
    this.clock.pause(true);
    this.drawing.dispose();
    this.renderer.dispose();
  }

  private framed(camera: CameraState): CameraState {
    const { width, height } = this.size;
    return fit(camera, this.bounds, width / height);
  }

  private moveTo(camera: CameraState): void {
    if (!isUsable(camera)) return;
    this.cameraNow = camera;
    this.clock.invalidate(true);
    this.onCamera?.();
  }

  private lose(isLost: boolean): void {
    this.isLost = isLost;
    this.clock.pause(isLost);
    // The objects on the graphics card are gone. The next frame makes them anew.
    if (isLost) this.drawing.dispose();
    this.onLost?.(isLost);
  }

  private click(x: number, y: number): void {
    const point = this.measuring.isOn || this.onClick !== null ? (this.pick(x, y)?.point ?? null) : null;
    if (point === null) return;
    if (this.measuring.click(point, (other) => this.places.isAt(other, x, y))) this.invalidate();
    this.onClick?.(point);
  }

  private hoverAt(at: { x: number; y: number } | null): void {
    this.hover = at;
    const isNeeded = this.brush.radius !== null || this.measuring.followsPointer;
    const found = at && isNeeded ? this.pick(at.x, at.y) : null;
    if (found || this.hovered) this.invalidate();
    this.hovered = found;
  }

  /// Pixels of the canvas per CSS pixel. The processor draws motion with one at most.
  private pixelRatio(scale: number): number {
    const ratio = this.pixels.ratio(scale);
    return this.isSoftware && scale < 1 ? Math.min(ratio, scale) : ratio;
  }

  private overlayLines(): OverlayLine[] {
    const { frozen, styleNow, hovered } = this;
    const frustum = frozen ? frustumLines(frozen.camera, frozen.aspect, styleNow.background) : [];
    return [...frustum, ...this.measuring.lines(hovered?.point ?? null), ...markDots(this.marks)];
  }

  /// Draws a frame for the clock.
  private drawFrame(now: number, detail: Detail): Drawn {
    const moves = this.controls.tick(now);
    return { moves, ...(this.isLost ? { points: 0, isWhole: true } : this.render(detail)) };
  }

  /// The processor, or the graphics card, has drawn the last frame.
  private hasDrawn(): void {
    const frame = this.clock.drawn();
    if (frame !== null) this.onPicture?.(frame);
    if (this.isSoftware) this.onDrawn?.();
  }

  private render({ scale, mostPoints }: Detail): { points: number; isWhole: boolean } {
    const { brush, hovered, cameraNow: camera, bounds, styleNow: style, frozen } = this;
    const ratio = this.pixelRatio(scale);
    const where = hovered && brush.radius !== null ? { centre: hovered.point, radius: brush.radius } : null;
    const drawn = this.drawing.render(
      { camera, bounds, style, frozen, brush: where, lines: this.overlayLines() },
      { ...this.pixels.size(ratio, this.stores.length), ratio, isQuick: this.isSoftware && scale < 1, mostPoints },
    );
    this.watch.begin();
    return drawn;
  }
}
