// SPDX-License-Identifier: Apache-2.0
// Makes the API's request for points from settings and a camera.

import { create, toBinary, type MessageInitShape } from "@bufbuild/protobuf";

import {
  type CameraSchema,
  CurvatureKind,
  PointAttribute,
  Sampler,
  SampleRequestSchema,
  Sequence,
  type DensityTermSchema,
} from "../gen/curvecast/v1/curvecast_pb";
import type { CameraState } from "../view";
import { halfHeight } from "../view/camera_math";
import type { Dab, Settings } from "./settings";

/// The fields of a SampleRequest.
export type SampleInit = MessageInitShape<typeof SampleRequestSchema>;
type TermInit = MessageInitShape<typeof DensityTermSchema>;

const kinds = { gauss: CurvatureKind.GAUSS, mean: CurvatureKind.MEAN, max: CurvatureKind.MAX };
const sequences = {
  jittered: Sequence.JITTERED,
  regular: Sequence.REGULAR,
  vanDerCorput: Sequence.VAN_DER_CORPUT,
  goldenRatio: Sequence.GOLDEN_RATIO,
};

/// Encodes a request, so that it can be compared with another one.
export function bytesOf(sample: SampleInit): Uint8Array {
  return toBinary(SampleRequestSchema, create(SampleRequestSchema, sample));
}

export function sameBytes(a: Uint8Array, b: Uint8Array): boolean {
  return a.length === b.length && a.every((byte, i) => byte === b[i]);
}

function vec3([x, y, z]: readonly [number, number, number]): { x: number; y: number; z: number } {
  return { x, y, z };
}

function cameraOf(camera: CameraState): MessageInitShape<typeof CameraSchema> {
  const opening =
    camera.orthographic === true ? { orthographicHeight: 2 * halfHeight(camera) } : { verticalFovDegrees: camera.fov };
  return { eye: vec3(camera.eye), target: vec3(camera.target), up: vec3(camera.up), ...opening };
}

/// Whether the points are for one picture: then there may be more of them where it shows.
export function isForThePicture({ screen, frustum, section }: Settings): boolean {
  return screen && frustum && section === "none"; // what is even on the screen has no points on the insides of what is cut open
}

/// Makes the terms of all settings but the brush.
function plainTerms(settings: Settings): TermInit[] {
  const { curvature } = settings;
  const isOpen = settings.section !== "none";
  const terms: TermInit[] = [];
  if (curvature !== "none") {
    terms.push({ term: { case: "curvature", value: { kind: kinds[curvature], exponent: settings.curvatureExponent } } });
  }
  if (settings.silhouette) terms.push({ term: { case: "view", value: { s0: settings.silhouetteFloor } } });
  if (settings.distance || (settings.screen && isOpen)) terms.push({ term: { case: "distance", value: {} } });
  if (settings.detail && isForThePicture(settings)) return [...terms, { term: { case: "picture", value: {} } }];
  if (settings.screen && !isOpen) terms.push({ term: { case: "screen", value: {} } });
  if (settings.frustum) terms.push({ term: { case: "frustum", value: {} } });
  return terms;
}

/// Makes one term of all dabs; none where there are none.
function paint(dabs: readonly Dab[]): TermInit[] {
  const strokes: { first: Dab; path: number[] }[] = [];
  for (const dab of dabs) {
    const last = strokes.at(-1);
    if (last === undefined || last.first.stroke !== dab.stroke) strokes.push({ first: dab, path: [] });
    else last.path.push(...dab.centre.map((x, i) => x - last.first.centre[i]!));
  }
  if (strokes.length === 0) return [];
  return [
    {
      term: {
        case: "brush",
        value: {
          strokes: strokes.map(({ first: { centre, radius, factor }, path }) => ({ centre: vec3(centre), radius, factor, path })),
        },
      },
    },
  ];
}

function budgetOf(settings: Settings, mostPoints: number): NonNullable<SampleInit["budget"]> {
  switch (settings.budget) {
    case "points":
      return { case: "points", value: BigInt(Math.round(settings.points)) };
    case "bytes":
      return { case: "maxBytes", value: BigInt(Math.round(1024 * settings.kilobytes)) };
    case "pixels":
      return { case: "pixelError", value: settings.pixelError };
    case "automatic":
      return { case: "automatic", value: { frameSeconds: settings.frameMilliseconds / 1000, maxPoints: BigInt(mostPoints) } };
  }
}

/// Makes the request for a view. `uniform`: its density is even, whatever the settings say. `size`: of the picture, in pixels.
/// `mostPoints`: of the automatic budget; 0: as many as the server gives.
export function sampleRequest(
  settings: Settings,
  camera: CameraState,
  size: { width: number; height: number },
  uniform = false,
  mostPoints = 0,
): SampleInit {
  const terms = uniform ? [] : plainTerms(settings);
  const needsCamera =
    settings.budget === "pixels" || (!uniform && (settings.silhouette || settings.distance || settings.screen || settings.frustum));
  const attributes: PointAttribute[] = [];
  if (settings.colouring === "curvature") attributes.push(PointAttribute.CURVATURES);
  if (settings.colouring === "rank" && settings.sampler === "progressive") attributes.push(PointAttribute.RANK);
  return {
    budget: budgetOf(settings, mostPoints),
    density: [...terms, ...(uniform ? [] : paint(settings.dabs))],
    // A request without a camera stays the same while the camera moves, and is not sent again.
    cameras: needsCamera ? [cameraOf(camera)] : [],
    ...(needsCamera && {
      viewport: { width: Math.max(1, Math.round(size.width)), height: Math.max(1, Math.round(size.height)) },
    }),
    sampler: settings.sampler === "progressive" ? Sampler.PROGRESSIVE : Sampler.EQUALISED,
    sequence: sequences[settings.sequence],
    attributes,
  };
}

/// Makes the request for the vertices of the mesh: those of the surface's own density, and of the camera's where that is wanted, too.
/// Otherwise the mesh would change with every turn, and have hardly a vertex where the camera does not look. `camera` and `size` as in
/// sampleRequest().
export function meshRequest(settings: Settings, camera: CameraState, size: { width: number; height: number }): SampleInit {
  const ofSurface = settings.meshForCamera ? {} : { silhouette: false, distance: false, screen: false, frustum: false };
  return sampleRequest(
    { ...settings, ...ofSurface, budget: "points", points: settings.meshVertices, colouring: "shading" },
    camera,
    size,
  );
}
