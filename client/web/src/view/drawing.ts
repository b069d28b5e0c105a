// SPDX-License-Identifier: Apache-2.0
// Draws the pictures of a canvas: points or a surface, a wireframe and lines over them.

import * as THREE from "three";
import type { PointStore } from "../stream/point_store";
import type { SurfaceMesh } from "../stream/decoded_surface";
import type { TriangleMesh } from "../stream/triangle_mesh";
import { type Bounds, boundsRadius } from "./camera_math";
import { OverlayLines, type OverlayLine } from "./overlay_lines";
import { WorkerEndsFinder } from "./discs/ends_finder";
import type { Passes, Rectangle } from "./picture";
import { PointsGeometry } from "./points_geometry";
import { SolidPasses } from "./solid_passes";
import { canBlend, SplatPasses } from "./splat_passes";
import { StoreEnds } from "./discs/store_ends";
import { SurfaceGeometry } from "./surface_geometry";
import { aim, AimedCamera } from "./three_camera";
import type { CameraState, FrozenCamera, Style, Vec } from "./types";
import { Wireframe } from "./wireframe";

/// How far behind triangles lines are drawn, in radii of the surface's box.
const surfaceTolerance = 0.002;

/// What pictures show besides the points. One beside the other, they have all of it in common.
export interface Scene {
  camera: CameraState;
  /// Corners of the surface's box.
  bounds: Bounds;
  style: Style;
  frozen: FrozenCamera | null;
  /// Where the brush would paint.
  brush: { centre: Vec; radius: number } | null;
  lines: readonly OverlayLine[];
}

/// How finely pictures are drawn.
export interface Fineness {
  /// Of one picture, in pixels.
  width: number;
  height: number;
  /// Pixels per CSS pixel.
  ratio: number;
  /// Drawn soon rather than finely.
  isQuick: boolean;
  /// All pictures together have about so many points at most: an even part of those that there are.
  mostPoints: number;
}

/// Keeps what is drawn on the graphics card.
export class Drawing {
  private readonly passes: Passes;
  private readonly overlay = new OverlayLines();
  private readonly wireframe = new Wireframe();
  private readonly drawn = new AimedCamera();
  private readonly sampled = new AimedCamera();
  private readonly finder = new WorkerEndsFinder();
  private readonly geometries = new Map<PointStore, PointsGeometry>();
  private stores: readonly (PointStore | null)[] = [null];
  private surface: SurfaceGeometry | null = null;

  /// `onChange` is called when another picture of the same points has to be drawn.
  constructor(
    private readonly renderer: THREE.WebGLRenderer,
    private readonly onChange: () => void,
  ) {
    this.passes = canBlend(renderer) ? new SplatPasses(renderer) : new SolidPasses(renderer);
  }

  /// Draws one picture for each store from now on.
  setStores(stores: readonly (PointStore | null)[]): void {
    this.stores = stores;
    for (const [store, points] of this.geometries) {
      if (stores.includes(store)) continue;
      points.dispose();
      this.geometries.delete(store);
    }
    for (const store of stores) {
      if (store && !this.geometries.has(store)) this.geometries.set(store, this.makeGeometry(store));
    }
  }

  private makeGeometry(store: PointStore): PointsGeometry {
    const { shape } = this.passes;
    // Cones meet halfway, creases or not.
    const hasEnds = shape === "square" && store.isSurface;
    return new PointsGeometry(store, shape, hasEnds ? new StoreEnds(store, this.finder, this.onChange) : null);
  }

  /// Whether surfaces can be drawn.
  get drawsSurfaces(): boolean {
    return this.passes.drawsSurfaces;
  }

  /// Draws a surface instead of the last store where the style wants it; null: none. Precondition: drawsSurfaces.
  setSurface(mesh: SurfaceMesh | null): void {
    this.surface?.dispose();
    this.surface = mesh && new SurfaceGeometry(mesh);
  }

  /// Draws the edges of a mesh over the picture of the last store; null: none.
  setWireframe(mesh: TriangleMesh | null): void {
    this.wireframe.set(mesh);
  }

  /// Uploads the stores' changes to the graphics card.
  upload(style: Style): void {
    for (const points of this.geometries.values()) {
      points.refresh(style);
      points.upload(this.renderer);
    }
  }

  /// Finds where discs end now, rather than after the next pictures.
  completeEnds(style: Style): void {
    for (const points of this.geometries.values()) {
      points.refresh(style);
      points.ends?.complete();
    }
  }

  /// Draws the pictures beside each other, over the whole canvas. Returns how many points they have, and whether these are all.
  render(scene: Scene, { width, height, ratio, isQuick, mostPoints }: Fineness): { points: number; isWhole: boolean } {
    const { renderer, stores } = this;
    const { camera, bounds, style, brush } = scene;
    const canvas = renderer.domElement;
    const canvasWidth = width * stores.length;
    if (canvas.width !== canvasWidth || canvas.height !== height) renderer.setSize(canvasWidth, height, false);
    this.upload(style);
    const surface = style.mode === "mesh" ? this.surface : null;
    const drawn = surface ? stores.slice(0, -1) : stores; // the last picture is of the surface
    const slots = drawn.reduce((sum, store) => sum + (store?.slots ?? 0), 0);
    const stride = Math.max(1, Math.ceil(slots / mostPoints));
    for (const points of this.geometries.values()) points.thin(stride);
    this.overlay.set(scene.lines);
    if (scene.frozen) aim(this.sampled, scene.frozen.camera, bounds, scene.frozen.aspect);
    const frozen = scene.frozen && { ...scene.frozen, camera: this.sampled };
    renderer.setScissorTest(true);
    for (const [i, store] of stores.entries()) {
      const isLast = i === stores.length - 1;
      const where: Rectangle = { x: i * width, y: 0, width, height };
      aim(this.drawn, camera, bounds, width / height);
      const points = store ? (this.geometries.get(store) ?? null) : null;
      const triangles = isLast ? surface : null;
      this.passes.render({
        points,
        surface: triangles,
        style,
        camera: this.drawn,
        where,
        pixelRatio: ratio,
        isQuick,
        sceneRadius: boundsRadius(bounds),
        frozen: isLast ? frozen : null, // the other's points are even on the surface
        brush: brush && { centre: new THREE.Vector3(...brush.centre), radius: brush.radius },
      });
      if (isLast) this.wireframe.render(renderer, this.drawn, style, ratio);
      const tolerance = triangles ? surfaceTolerance * boundsRadius(bounds) : 0.5 * (points?.typicalRadius ?? 0) * style.splatScale;
      this.overlay.render(renderer, this.drawn, where, ratio, points || triangles ? this.passes.depths : null, tolerance);
    }
    renderer.setScissorTest(false);
    return { points: slots / stride, isWhole: stride === 1 };
  }

  /// Gives back the objects on the graphics card. render() makes them anew.
  dispose(): void {
    for (const part of [this.passes, this.overlay, this.wireframe, ...this.geometries.values()]) part.dispose();
    this.surface?.dispose();
    this.finder.stop();
  }
}
