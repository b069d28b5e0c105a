// SPDX-License-Identifier: Apache-2.0
// The client that a page uses: one object for all calls of a server.

import type { MessageInitShape } from "@bufbuild/protobuf";

import {
  CurvecastService,
  type FrameStatistics,
  type Progress,
  type SampleRequestSchema,
  type Session,
  type SessionOptionsSchema,
} from "../gen/curvecast/v1/curvecast_pb";
import { WorkerDecoder, type Decoder } from "./decoder";
import { CurvecastError } from "./errors";
import { KeyedSockets, keyedEndpoint } from "./keyed_sockets";
import { ReconnectingSocket } from "./reconnecting_socket";
import { LiveView, type LiveViewEvents, type LiveViewOptions } from "./live_view";
import { meshIdOf } from "./mesh_id";
import { uploadMesh, type NamedFile, type UploadedMesh, type UploadOptions } from "./mesh_upload";
import { StreamedPoints } from "./point_store";
import { repeat } from "./repeat";
import { socketUrl, type Endpoint } from "./socket";
import type { SurfaceMesh } from "./decoded_surface";
import { readSurface } from "./surface_mesh";
import { readMesh, type TriangleMesh } from "./triangle_mesh";

const methods = CurvecastService.method;

/// Where the server is, and who asks. By default the server that the page comes from, without a token.
export interface ClientOptions extends Partial<Endpoint> {
  decoder?: Decoder; // close() leaves it open; default: worker threads that the client owns
}

/// What createSession() prepares. The stages are those of the API's Progress.
export interface SessionRequest {
  meshId: string;
  companions?: Record<string, string>;
  options?: MessageInitShape<typeof SessionOptionsSchema>;
  onProgress?(progress: Progress): void;
  /// There is a coarse stand-in to look at, under the id of the session: a view of it may be opened. Its stream goes on with the session.
  onPreview?(preview: Session): void;
  signal?: AbortSignal;
}

/// How to make a mesh, how to follow that, and how to stop it.
export interface RemeshOptions {
  relaxations?: number; // rounds in which triangles become more regular, 0 to 100; default 5
  onProgress?(progress: Progress): void;
  signal?: AbortSignal;
}

/// Calls the service. All calls about a mesh but uploads and remeshing share a socket, which is opened when a call needs it, and again
/// after it was lost. Calls reject with a CurvecastError.
export class Client {
  private readonly endpoint: Endpoint;
  private readonly decoder: Decoder;
  private readonly connections: KeyedSockets;
  private readonly meshConnections: KeyedSockets; // meshes are large: frames would wait behind them
  private readonly closing = new Set<{ close(): void }>(); // ends with the client

  constructor({ url, token, webSocket, decoder }: ClientOptions = {}) {
    this.endpoint = { url: url ?? socketUrl("."), token, ...(webSocket !== undefined && { webSocket }) };
    this.connections = new KeyedSockets(this.endpoint);
    this.meshConnections = new KeyedSockets(this.endpoint);
    if (decoder === undefined) this.closing.add((decoder = new WorkerDecoder()));
    this.decoder = decoder;
    this.closing.add(this.connections).add(this.meshConnections);
  }

  /// Lists the sessions that the server has in memory, by id.
  async listSessions(signal?: AbortSignal): Promise<Session[]> {
    const sessions: Session[] = [];
    let pageToken = "";
    do {
      const page = await this.connections.socket().unary(methods.listSessions, { pageToken }, signal);
      sessions.push(...page.sessions);
      if (page.nextPageToken !== "" && page.nextPageToken === pageToken) {
        throw new CurvecastError("DATA_LOSS", "the server's pages of sessions do not end");
      }
      pageToken = page.nextPageToken;
    } while (pageToken !== "");
    return sessions;
  }

  /// Asks for one session. Rejects with NOT_FOUND where neither the server's memory nor its cache has it.
  async getSession(sessionId: string, signal?: AbortSignal): Promise<Session> {
    return present((await this.connections.socket(sessionId).unary(methods.getSession, { sessionId }, signal)).session);
  }

  /// Has a mesh preprocessed, or joins the session that there is. Resolves when the session is ready. Joins again where the connection
  /// is lost meanwhile, and rejects with UNAVAILABLE after a minute without one.
  async createSession(wanted: SessionRequest): Promise<Session> {
    const { meshId, companions = {}, options, signal } = wanted;
    const request = { meshId, companions, ...(options !== undefined && { options }) };
    return repeat(async (resetFailures) => {
      let session: Session | undefined;
      for await (const { update } of this.connections.socket(meshId).serverStream(methods.createSession, request, signal)) {
        resetFailures();
        if (update.case === "progress") wanted.onProgress?.(update.value);
        if (update.case === "preview") wanted.onPreview?.(update.value);
        if (update.case === "session") session = update.value;
      }
      return present(session);
    }, signal);
  }

  /// Pins a session in the server's memory, or unpins it.
  async pinSession(sessionId: string, pinned: boolean, signal?: AbortSignal): Promise<Session> {
    return present((await this.connections.socket(sessionId).unary(methods.updateSession, { sessionId, pinned }, signal)).session);
  }

  /// Has the server forget a session, in its memory and in its cache.
  async closeSession(sessionId: string, signal?: AbortSignal): Promise<void> {
    await this.connections.socket(sessionId).unary(methods.closeSession, { sessionId }, signal);
  }

  /// Uploads a mesh, and the files among `others` that it refers to. Uses a socket apart from the other calls, so that these do not wait;
  /// see uploadFile() for what happens where that socket is lost.
  async upload(mesh: NamedFile, others: readonly NamedFile[] = [], options: UploadOptions = {}): Promise<UploadedMesh> {
    this.connections.checkOpen();
    const meshId = await meshIdOf(mesh.data);
    this.connections.checkOpen();
    const connection = new ReconnectingSocket(keyedEndpoint(this.endpoint, meshId));
    this.closing.add(connection);
    try {
      return await uploadMesh(() => connection.socket(), mesh, others, options);
    } finally {
      connection.close();
      this.closing.delete(connection);
    }
  }

  /// Asks for one set of points.
  async resample(
    sessionId: string,
    sample: MessageInitShape<typeof SampleRequestSchema>,
    signal?: AbortSignal,
  ): Promise<{ points: StreamedPoints; statistics: FrameStatistics | null }> {
    const blocks = [];
    let statistics: FrameStatistics | null = null;
    for await (const response of this.connections.socket(sessionId).serverStream(methods.resample, { sessionId, sample }, signal)) {
      if (response.points !== undefined) blocks.push(response.points);
      statistics = response.statistics ?? statistics;
    }
    const points = new StreamedPoints();
    points.replace(await this.decoder.decode(blocks));
    return { points, statistics };
  }

  /// Makes a triangle mesh of the points of a sample, whose budget is in points: as many vertices as points. Begins again where the
  /// connection is lost meanwhile, as createSession() does.
  async remesh(
    sessionId: string,
    sample: MessageInitShape<typeof SampleRequestSchema>,
    options: RemeshOptions = {},
  ): Promise<TriangleMesh> {
    const { relaxations, signal } = options;
    const request = { sessionId, sample, ...(relaxations !== undefined && { relaxations }) };
    return repeat((resetFailures) => {
      const responses = this.meshConnections.socket(sessionId).serverStream(methods.remesh, request, signal);
      return readMesh(responses, this.decoder, (progress) => (resetFailures(), options.onProgress?.(progress)));
    }, signal);
  }

  /// Asks for the surface's own triangles. Rejects with FAILED_PRECONDITION where the surface has textures, with OUT_OF_RANGE where it has
  /// too many triangles. Begins again where the connection is lost meanwhile.
  async surface(sessionId: string, { signal }: { signal?: AbortSignal } = {}): Promise<SurfaceMesh> {
    return repeat((resetFailures) => {
      const responses = this.meshConnections.socket(sessionId).serverStream(methods.getSurface, { sessionId }, signal);
      return readSurface(responses, this.decoder, resetFailures);
    }, signal);
  }

  /// Opens a stream of views of a session: see LiveView.
  view(sessionId: string, events: LiveViewEvents = {}, options: LiveViewOptions = {}): LiveView {
    this.connections.checkOpen();
    const view = new LiveView(
      () => this.connections.socket(sessionId),
      this.decoder,
      sessionId,
      events,
      options,
      (over) => this.closing.delete(over),
    );
    this.closing.add(view);
    return view;
  }

  /// Ends all calls, uploads and views, and the decoder's threads where the client owns them. Later calls are CANCELLED.
  close(): void {
    for (const one of this.closing) one.close();
    this.closing.clear();
  }
}

function present(session: Session | undefined): Session {
  if (session === undefined) throw new CurvecastError("INTERNAL", "the server did not say which session");
  return session;
}
