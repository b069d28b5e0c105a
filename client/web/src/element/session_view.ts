// SPDX-License-Identifier: Apache-2.0
// What an element shows while it is in a page: a session of a server, in a picture of its own.

import { DrawingBudget } from "../app/drawing_budget";
import { askFirst } from "../app/first_answers";
import { sampleRequest, type SampleInit } from "../app/sample_request";
import { SessionChoice, tryingAgain } from "../app/session_choice";
import { defaultSettings, takeCamera, type Settings } from "../app/settings";
import { Streams } from "../app/streams";
import { SurfaceView } from "../app/surface_view";
import { ViewPacer } from "../app/view_pacer";
import { applyView, styleOf } from "../app/view_settings";
import { Client, type CurvecastError, type FrameReport, type LiveViewState, type Session } from "../stream";
import { Viewport, type CameraState } from "../view";
import { shownSettings, type Attributes, type SessionSource } from "./element_source";
import type { MessageLine } from "./message_line";
import { releaseDecoder, takeDecoder } from "./shared_decoder";

const longestStart = 500; // ms that the first picture waits for points

/// What it tells.
export interface SessionViewEvents {
  /// The first points of a session are in the picture.
  onReady(session: Session): void;
  onFrame(frame: FrameReport): void;
  onError(error: CurvecastError): void;
}

/// Shows the session of a source on a canvas, from the constructor to close(). The constructor throws NoWebGL2Error.
export class SessionView {
  readonly viewport: Viewport;
  session: Session | null = null;
  private readonly client: Client;
  private readonly defaults: Settings;
  private readonly surface: SurfaceView;
  private readonly choice: SessionChoice;
  private readonly drawingBudget = new DrawingBudget();
  private readonly pacer: ViewPacer;
  private settings: Settings;
  private addressCamera: CameraState | null;
  private streams: Streams | null = null;
  private isReady = false;
  private isHinted = false;
  private isClosed = false;

  constructor(
    readonly source: SessionSource,
    private readonly attributes: Attributes,
    private readonly canvas: HTMLCanvasElement,
    private readonly message: MessageLine,
    private readonly events: SessionViewEvents,
  ) {
    this.viewport = new Viewport(canvas);
    this.viewport.expectPoints(longestStart); // an empty picture would take the processor's time from them
    const isDark = matchMedia("(prefers-color-scheme: dark)").matches;
    this.defaults = defaultSettings(this.viewport.isSoftware, isDark ? "dark" : "light");
    ({ settings: this.settings, camera: this.addressCamera } = shownSettings(attributes, this.defaults));
    this.client = new Client({ url: source.url, token: source.token, decoder: takeDecoder() });
    this.pacer = new ViewPacer(
      () => this.look(),
      () => this.viewport.isDrawing,
    );
    this.surface = new SurfaceView(this.client, this.viewport, this.defaults, {
      changed: () => this.surfaceCame(),
      notice: (text) => console.info(`curvecast: ${text}`), // discs do as well
    });
    this.choice = this.makeChoice();
    this.listen();
    this.applySettings();
    const { sessionId } = source;
    const answers =
      sessionId === null
        ? askFirst(this.client, null)
        : { sessions: Promise.resolve([]), session: this.client.getSession(sessionId) };
    answers.session?.catch(() => {}); // the choice takes its error
    this.choice.start(answers, sessionId, this.addressCamera);
  }

  /// Takes attributes that have changed. Precondition: the source is the same.
  attributesChanged(): void {
    const { settings, camera } = shownSettings(this.attributes, this.defaults);
    const isOtherCamera = JSON.stringify(camera) !== JSON.stringify(this.addressCamera);
    this.settings = settings;
    this.addressCamera = camera;
    takeCamera(settings, this.viewport.camera); // the visitor may have turned it
    this.applySettings();
    if (isOtherCamera && camera !== null) this.viewport.camera = camera;
    this.pacer.request();
  }

  /// Ends the stream, the connection and the picture.
  close(): void {
    if (this.isClosed) return;
    this.isClosed = true;
    this.choice.stop();
    this.streams?.close();
    this.streams = null;
    this.surface.close();
    this.client.close();
    releaseDecoder();
    this.viewport.dispose();
    // Browsers give a page some 16 contexts, and would keep this one until the canvas is collected.
    this.canvas.getContext("webgl2")?.getExtension("WEBGL_lose_context")?.loseContext();
  }

  private makeChoice(): SessionChoice {
    const { message, source } = this;
    return new SessionChoice(
      this.client,
      {
        onSessions: () => {},
        onReady: (session, camera) => this.show(session, camera),
        onNone: () => message.say("session", "The server has no session that is ready yet …"),
        onWaiting: (text, error) => {
          message.say("session", text);
          if (error === undefined) return;
          if (error.code === "UNAVAILABLE") this.hint();
          this.events.onError(error);
        },
        onFailure: (id, error) =>
          this.fail(error.code === "NOT_FOUND" ? `The server does not have the session ${id}` : error.message, error),
        onRefused: (error) => this.refused(error),
      },
      () => source.sessionId === null && this.session === null && !document.hidden, // else the list is of no use
    );
  }

  /// Tells who makes the page what its visitors need not know: browsers hide why a server has refused a socket.
  private hint(): void {
    const { url } = this.source;
    if (this.isHinted || new URL(url).host === location.host) return;
    this.isHinted = true;
    console.info(`curvecast: there is no way to ${url}. Is it there, and was it started with --web-origin ${location.origin}?`);
  }

  private listen(): void {
    const { viewport } = this;
    viewport.onCamera = viewport.onResize = () => {
      takeCamera(this.settings, viewport.camera);
      this.pacer.request();
    };
    viewport.onPicture = ({ points, milliseconds, isFine }) => {
      const { budget, frameMilliseconds } = this.settings;
      if (isFine && budget === "automatic" && points > 0 && this.drawingBudget.note(points, milliseconds, frameMilliseconds))
        this.pacer.request();
    };
    viewport.onDrawn = () => this.pacer.drawn();
    viewport.onLost = (isLost) => {
      if (!this.isClosed) this.message.say("graphics", isLost ? "The graphics card was lost; the picture waits …" : null);
    };
  }

  private applySettings(): void {
    applyView(this.settings, this.viewport);
    this.applyStyle();
  }

  private applyStyle(onlyIfOther = false): void {
    const { settings, surface, streams, viewport } = this;
    const isOther = surface.follow(settings, streams?.main.statistics().bytes ?? 0, true);
    if (onlyIfOther && !isOther) return;
    viewport.style = styleOf(settings, surface.modeOf(settings), () => [], viewport.bounds);
  }

  private show(session: Session, camera: CameraState | null): void {
    const { viewport } = this;
    this.session = session;
    const { boxMin, boxMax } = session.report?.mesh ?? {};
    if (boxMin !== undefined && boxMax !== undefined) {
      viewport.setBounds([boxMin.x, boxMin.y, boxMin.z], [boxMax.x, boxMax.y, boxMax.z]);
    }
    this.surface.open(session);
    this.streams = new Streams(this.client, session, {
      onFrame: (frame) => this.frameCame(frame),
      onState: (_which, state, error) => this.stateChanged(state, error),
    });
    viewport.setStores(this.streams.main.store);
    if (camera !== null) viewport.camera = camera;
    else viewport.frame();
    this.applySettings();
    this.look();
  }

  private look(): void {
    const { streams, settings, viewport } = this;
    if (streams === null) return;
    this.applyStyle(true); // more bytes of points may have come
    const ask = (isUniform: boolean): SampleInit =>
      sampleRequest(settings, viewport.camera, viewport.size, isUniform, this.drawingBudget.mostPoints);
    if (this.surface.needsPoints && streams.look(ask(false), ask(true))) viewport.expectPoints();
  }

  private frameCame(frame: FrameReport): void {
    const { viewport, message } = this;
    if (frame.error !== null) {
      viewport.expectNoPoints();
      const isNowhere = frame.error.code === "FAILED_PRECONDITION"; // the view's density is zero everywhere
      message.say("view", isNowhere ? "Nothing of the surface is in view here" : frame.error.message);
      this.events.onError(frame.error);
    } else {
      message.say("view", null);
      if (frame.added + frame.removed + frame.resized > 0) viewport.uploadNow();
      else viewport.expectNoPoints();
      this.becomeReady();
    }
    this.events.onFrame(frame);
  }

  private becomeReady(): void {
    if (this.isReady || this.session === null) return;
    this.isReady = true;
    this.events.onReady(this.session);
  }

  private surfaceCame(): void {
    this.applyStyle();
    this.viewport.pointsChanged();
    if (this.surface.shown !== null) this.becomeReady();
    this.pacer.request();
  }

  private stateChanged(state: LiveViewState, error: CurvecastError | null): void {
    const { message } = this;
    if (state === "connecting") return;
    message.say("stream", state === "reconnecting" && error !== null ? tryingAgain(error) : null, () => this.streams?.retryNow());
    if (error === null) return;
    if (state !== "failed") this.events.onError(error);
    else if (error.code === "UNAUTHENTICATED" || error.code === "PERMISSION_DENIED") this.refused(error);
    else this.fail(error.message, error);
  }

  private refused(error: CurvecastError): void {
    this.fail(`The server does not let this page see the session: ${error.message}`, error);
  }

  /// Says what nothing is tried against any more.
  private fail(text: string, error: CurvecastError): void {
    this.viewport.expectNoPoints();
    this.message.say("failure", text);
    this.events.onError(error);
  }
}
