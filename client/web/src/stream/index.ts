// SPDX-License-Identifier: Apache-2.0
// The streaming client: sessions, uploads, and points that follow a camera. It needs neither three.js nor a page.

export type { PointChanges } from "./changed_slots";
export { Client, type ClientOptions, type RemeshOptions, type SessionRequest } from "./client";
export type { DecodedPoints, ScalarColumn } from "./decoded_points";
export { WorkerDecoder, type Decoder } from "./decoder";
export { asCurvecastError, CurvecastError, type ErrorCode } from "./errors";
export { LiveView, type LiveViewEvents, type LiveViewOptions, type LiveViewState } from "./live_view";
export { meshAmong, type NamedFile, type UploadedMesh, type UploadOptions } from "./mesh_upload";
export { StreamedPoints, type PointDifference, type PointStore } from "./point_store";
export { Socket, socketUrl, type Endpoint } from "./socket";
export type { FrameReport, StatisticsSummary } from "./statistics";
export type { SurfaceMesh } from "./decoded_surface";
export type { TriangleMesh } from "./triangle_mesh";
export {
  CurvatureKind,
  PointAttribute,
  PointLimit,
  Sampler,
  SampleRequestSchema,
  Sequence,
  SessionState,
  type FrameStatistics,
  type SampleRequest,
  type Session,
} from "../gen/curvecast/v1/curvecast_pb";
