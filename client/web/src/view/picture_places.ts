// SPDX-License-Identifier: Apache-2.0
// Places of a canvas that shows pictures beside each other, in CSS pixels, and what the pictures have there.

import type { PointStore } from "../stream/point_store";
import type { SurfaceMesh } from "../stream/decoded_surface";
import { type Bounds, boundsRadius, clipPlanes, halfHeight, placeInPicture, rayThrough } from "./camera_math";
import { pick } from "./picking";
import { pickSurface } from "./surface_picking";
import type { CameraState, Pick, Ray, Style, Vec } from "./types";

const surfacePickRadius = 0.005; // of picks of triangles, in radii of the surface's box
const pickReach = 8; // CSS pixels between the pointer and a point that it is meant for

/// What is shown.
export interface Shown {
  stores: readonly (PointStore | null)[];
  surface: SurfaceMesh | null;
  camera: CameraState;
  bounds: Bounds;
  style: Style;
}

/// Converts between places of a canvas and places in space.
export class PicturePlaces {
  /// `shown` returns what is shown at the moment.
  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly shown: () => Shown,
  ) {}

  /// Size of the canvas.
  get size(): { width: number; height: number } {
    return { width: this.canvas.clientWidth || 1, height: this.canvas.clientHeight || 1 };
  }

  /// Finds the surface, or the nearest visible point.
  pick(x: number, y: number): Pick | null {
    const { camera, bounds, style, surface } = this.shown();
    const { store, isLast } = this.partAt(x);
    const { near } = clipPlanes(camera, bounds);
    if (surface && isLast && style.mode === "mesh") {
      return pickSurface(surface, this.rayAt(x, y), near, surfacePickRadius * boundsRadius(bounds), style.section);
    }
    if (!store) return null;
    const half = camera.orthographic === true ? halfHeight(camera) : Math.tan((camera.fov * Math.PI) / 360);
    const tolerance = (pickReach * 2 * half) / this.size.height;
    return pick(store, this.rayAt(x, y), near, tolerance, style.splatScale, style.section);
  }

  rayAt(x: number, y: number): Ray {
    const { camera, bounds } = this.shown();
    const { left, width } = this.partAt(x);
    const { height } = this.size;
    return rayThrough(camera, bounds, width / height, (2 * (x - left)) / width - 1, 1 - (2 * y) / height);
  }

  /// Returns where a point is in the last of the pictures; null where it is beside it.
  placeOf(point: Vec): { x: number; y: number } | null {
    const { left, width } = this.partAt(Infinity);
    const { height } = this.size;
    const at = placeInPicture(this.shown().camera, width / height, point);
    return at && { x: left + 0.5 * (1 + at[0]) * width, y: 0.5 * (1 - at[1]) * height };
  }

  /// Whether a point is where the last of the pictures was clicked.
  isAt(point: Vec, x: number, y: number): boolean {
    const place = this.placeOf(point);
    return place !== null && Math.hypot(place.x - x, place.y - y) < pickReach;
  }

  /// Returns the picture at a column of the canvas: its store, its left edge and its width, and whether it is the last one.
  private partAt(x: number): { store: PointStore | null; left: number; width: number; isLast: boolean } {
    const { stores } = this.shown();
    const width = this.size.width / stores.length;
    const index = Math.min(stores.length - 1, Math.max(0, Math.floor(x / width)));
    return { store: stores[index] ?? null, left: index * width, width, isLast: index === stores.length - 1 };
  }
}
