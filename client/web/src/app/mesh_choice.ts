// SPDX-License-Identifier: Apache-2.0
// When the surface's own triangles are the better choice: where they are fewer bytes than points of it, and show all that is wanted.

import { maxSurfaceFaces } from "../stream/protocol";
import type { Settings } from "./settings";

const bytesOfFace = 1.5; // of a mesh, with 14 bits a coordinate
const leastBytes = 300;
const bytesOfPoint = 3.4;
const mostFacesInSoftware = 30_000; // that a processor draws about as fast as discs: moving pictures cannot leave triangles out

/// Expected bytes of the mesh.
export const meshBytes = (faces: number): number => leastBytes + bytesOfFace * faces;

/// Expected bytes of a view of so many points.
export const viewBytes = (points: number): number => bytesOfPoint * points;

/// Whether the mesh is fewer bytes than the points so far and those of another view. `faces`: 0 where it is not known.
export function isMeshSmaller(faces: number, pointBytes: number, viewPoints: number): boolean {
  return faces > 0 && faces <= maxSurfaceFaces && pointBytes + viewBytes(viewPoints) > meshBytes(faces);
}

/// Whether the mesh is drawn in reasonable time. `isSoftware`: by the processor.
export const isDrawnSoon = (faces: number, isSoftware: boolean): boolean => !isSoftware || faces <= mostFacesInSoftware;

/// Whether the mesh is as good as points for a page with these settings: the budget is the page's to choose, and nothing of the points
/// themselves is of interest.
export function suitsMesh(settings: Settings, defaults: Settings): boolean {
  const { mode, colouring, budget, splatScale, brush, dabs, split, frozen } = settings;
  const isLikeDefault = (["curvature", "silhouette", "distance", "screen", "frustum", "detail", "sampler"] as const).every(
    (key) => settings[key] === defaults[key],
  );
  return (
    budget === "automatic" &&
    mode === "splats" &&
    (colouring === "shading" || colouring === "colour") &&
    splatScale === defaults.splatScale &&
    isLikeDefault &&
    !brush &&
    dabs.length === 0 &&
    !split &&
    !frozen
  );
}
