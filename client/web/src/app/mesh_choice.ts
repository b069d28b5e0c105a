// When the surface's own triangles are the better choice: where they are fewer bytes than points of it, and show all that is wanted.

import { maxSurfaceFaces } from "../stream/protocol";
import type { Settings } from "./settings";

const bytesOfFace = 1.2; // of a mesh, with 14 bits a coordinate
const leastBytes = 300;
const bytesOfPoint = 3.4;
const mostFacesInSoftware = 30_000; // that a processor draws about as fast as discs: moving pictures cannot leave triangles out

/// Expected bytes of the mesh.
export const meshBytes = (faces: number): number => leastBytes + bytesOfFace * faces;

/// Expected bytes of a view; 0 where they are not known.
export function viewBytes({ budget, points, kilobytes }: Settings): number {
  return budget === "points" ? bytesOfPoint * points : budget === "bytes" ? 1024 * kilobytes : 0;
}

/// Whether the mesh is fewer bytes than the points so far and those of another view. `faces`: 0 where it is not known.
export function isMeshSmaller(faces: number, pointBytes: number, settings: Settings): boolean {
  return faces > 0 && faces <= maxSurfaceFaces && pointBytes + viewBytes(settings) > meshBytes(faces);
}

/// Whether the mesh is drawn in reasonable time. `isSoftware`: by the processor.
export const isDrawnSoon = (faces: number, isSoftware: boolean): boolean => !isSoftware || faces <= mostFacesInSoftware;

/// Whether the mesh shows all that a page with these settings is to show: nothing of the points themselves is of interest, neither where
/// they lie nor how many they are.
export function suitsMesh(settings: Settings, defaults: Settings): boolean {
  const { mode, colouring, budget, points, splatScale, brush, dabs, split, frozen } = settings;
  const isLikeDefault = (["curvature", "silhouette", "distance", "screen", "frustum", "detail", "sampler"] as const).every(
    (key) => settings[key] === defaults[key],
  );
  return (
    settings.automaticMesh &&
    mode === "splats" &&
    (colouring === "shading" || colouring === "colour") &&
    (budget === "automatic" || (budget === "points" && points === defaults.points)) &&
    splatScale === defaults.splatScale &&
    isLikeDefault &&
    !brush &&
    dabs.length === 0 &&
    !split &&
    !frozen
  );
}
