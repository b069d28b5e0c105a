// The viewer's page: puts its parts together.

import {
  asCurvecastError,
  SessionState,
  type Client,
  type CurvecastError,
  type FrameReport,
  type LiveViewState,
  type Session,
} from "../stream";
import { Viewport, type CameraState } from "../view";
import { Brush } from "./brush";
import { download, plyOf } from "./export_ply";
import type { FirstAnswers } from "./first_answers";
import { length } from "./format";
import { Hud } from "./hud";
import { Messages } from "./messages";
import { Panel } from "./panel";
import { sampleRequest } from "./sample_request";
import { firstReady, nameOf, SessionList } from "./session_list";
import { defaultSettings, withinRange, type Settings } from "./settings";
import { Shortcuts } from "./shortcuts";
import { Streams } from "./streams";
import { Uploads } from "./upload";
import { keepToken, readState, writeState } from "./url_state";

const secondsBetweenLists = 5;
const secondsUntilReady = 1; // between questions whether a session is prepared
const secondsBeforeSave = 0.4; // of the address, after the last change
const secondsBetweenTries = 2; // where the server cannot be reached
const longestStart = 500; // ms without a picture
const noticeableDelay = 0.3; // seconds; a shorter loss of the connection is not spoken of

/// Its mesh's name without what tells the format.
function stemOf(session: Session): string {
  return nameOf(session).replace(/\.[a-z]+$/i, "");
}

/// One for a page. Throws NoWebGL2Error.
export class Application {
  readonly settings: Settings;
  readonly viewport: Viewport;
  streams: Streams | null = null;
  session: Session | null = null;

  private readonly defaults: Settings;
  private readonly panel: Panel;
  private readonly hud: Hud;
  private readonly list: SessionList;
  private readonly uploads: Uploads;
  private readonly brush: Brush;
  private wanted: { id: string; camera: CameraState | null } | null; // the session to show, until it is
  private isOpening = false; // that session was asked for, and its answer is awaited
  private frozen: { camera: CameraState; size: { width: number; height: number } } | null = null;
  private shown: unknown[] = []; // the stores that the viewport draws
  private isLookDue = false;
  private hasLooked = false; // since the last picture
  private retryTimer: ReturnType<typeof setTimeout> | undefined;
  private saveTimer: ReturnType<typeof setTimeout> | undefined;
  private uploadMilliseconds = 0;

  constructor(
    canvas: HTMLCanvasElement,
    page: HTMLElement,
    private readonly messages: Messages,
    private readonly client: Client,
    answers: FirstAnswers,
    private readonly token: string | undefined,
  ) {
    this.viewport = new Viewport(canvas);
    this.viewport.expectPoints(longestStart); // the server is asked for them first, and works while an empty picture is drawn
    this.defaults = defaultSettings(
      this.viewport.isSoftware,
      matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light",
    );
    const { session, camera, settings } = readState(location.hash, this.defaults);
    this.settings = { ...this.defaults, dabs: [], ...settings };
    this.wanted = session === null ? null : { id: session, camera };
    this.brush = new Brush(this.settings, (text) => this.messages.notice(text));
    this.hud = new Hud(page);
    this.list = new SessionList({
      open: (chosen) => this.choose(chosen.sessionId),
      forget: (chosen) => void this.forget(chosen),
    });
    this.uploads = new Uploads(page, () => this.client, {
      onReady: (ready, missing) => this.uploaded(ready, missing),
      onFailure: (what, error) => this.messages.failure(what, error),
    });
    const shortcuts = new Shortcuts(page, this.shortcuts());
    this.panel = new Panel(
      this.settings,
      {
        changed: () => this.changed(),
        upload: () => this.uploads.pick(),
        fit: () => this.viewport.frame(),
        undoStroke: () => this.change(() => this.brush.undo()),
        clearStrokes: () => this.change(() => this.brush.clear()),
        screenshot: () => void this.saveScreenshot(),
        exportPly: () => this.savePly(),
        help: () => shortcuts.toggleHelp(),
      },
      this.list.root,
    );
    this.listen(canvas);
    this.changed();
    if (this.wanted !== null) void this.open(this.wanted.id, this.wanted.camera, answers.session ?? undefined);
    void this.refreshSessions(answers.sessions);
  }

  private listen(canvas: HTMLCanvasElement): void {
    this.viewport.onCamera = () => this.lookSoon();
    this.viewport.onDrawn = () => {
      if (this.isLookDue) this.lookSoon();
    };
    this.viewport.onBrush = (centre, done) => {
      if (this.brush.paint(centre, this.brushRadius(), done)) this.changed();
    };
    this.viewport.onMeasure = (_from, _to, distance) => this.messages.notice(`distance ${length(distance)}`);
    new ResizeObserver(() => this.lookSoon()).observe(canvas);
    window.addEventListener("hashchange", () => location.reload());
    setInterval(() => this.showFigures(), 250);
    setInterval(() => {
      if (!document.hidden && this.wanted === null) void this.refreshSessions();
    }, 1000 * secondsBetweenLists);
  }

  /// Settings have changed, by the panel or otherwise.
  private changed(): void {
    const { settings, viewport } = this;
    document.documentElement.dataset.theme = settings.background;
    document.body.classList.toggle("split", settings.split && this.session !== null);
    const { mode, colouring, background, edl, dotSize, splatScale } = settings;
    viewport.style = { mode, colouring, background, edl, dotSize, splatScale };
    viewport.navigation = settings.navigation;
    viewport.setMeasuring(settings.measuring && !settings.brush);
    viewport.setBrush(settings.brush && this.session !== null ? this.brushRadius() : null);
    if (settings.frozen !== (this.frozen !== null)) {
      this.frozen = settings.frozen ? { camera: viewport.camera, size: viewport.size } : null;
      viewport.setFrozenCamera(
        this.frozen?.camera ?? null,
        this.frozen === null ? undefined : this.frozen.size.width / this.frozen.size.height,
      );
    }
    viewport.invalidate();
    this.lookSoon();
  }

  /// Changes settings from outside of the panel.
  private change(how: (settings: Settings) => void): void {
    how(this.settings);
    this.panel.refresh();
    this.changed();
  }

  /// At once, but not more than once before the next picture: the server works while this one is drawn. Where the processor draws,
  /// they would only take each other's time.
  private lookSoon(): void {
    this.isLookDue = true;
    if (this.hasLooked || this.viewport.isDrawing) return;
    this.hasLooked = true;
    requestAnimationFrame(() => {
      this.hasLooked = false;
      if (this.isLookDue) this.lookSoon();
    });
    this.isLookDue = false;
    this.look();
  }

  private look(): void {
    const { streams, settings, viewport } = this;
    if (streams === null) return;
    this.showStores();
    const camera = this.frozen?.camera ?? viewport.camera;
    const size = this.frozen?.size ?? viewport.size;
    if (streams.look(sampleRequest(settings, camera, size), sampleRequest(settings, camera, size, true))) viewport.expectPoints();
    this.saveSoon();
  }

  /// One picture, or two.
  private showStores(): void {
    if (this.streams === null) return;
    this.streams.split(this.settings.split);
    const { main, beside } = this.streams;
    const stores = beside === null ? [main.store] : [beside.store, main.store];
    if (stores.length === this.shown.length && stores.every((store, i) => store === this.shown[i])) return;
    this.shown = stores;
    this.viewport.setStores(stores[0]!, stores[1]);
  }

  private brushRadius(): number {
    const { boxMin, boxMax } = this.session?.report?.mesh ?? {};
    if (boxMin === undefined || boxMax === undefined) return 1;
    return (this.settings.brushSize / 100) * Math.hypot(boxMax.x - boxMin.x, boxMax.y - boxMin.y, boxMax.z - boxMin.z);
  }

  private saveSoon(): void {
    clearTimeout(this.saveTimer);
    this.saveTimer = setTimeout(() => {
      if (this.session === null) return;
      history.replaceState(null, "", writeState(this.session.sessionId, this.viewport.camera, this.settings, this.defaults));
    }, 1000 * secondsBeforeSave);
  }

  private async refreshSessions(answer = this.client.listSessions()): Promise<void> {
    let sessions: Session[];
    try {
      sessions = await answer;
    } catch (thrown) {
      return this.listFailed(asCurvecastError(thrown));
    }
    if (this.streams === null && !this.isOpening) this.messages.hideBanner();
    this.list.show(sessions, this.session?.sessionId ?? null);
    if (this.wanted !== null && !this.isOpening) return this.open(this.wanted.id, this.wanted.camera);
    if (this.wanted !== null || this.session !== null) return;
    const first = firstReady(sessions);
    if (first !== null) this.show(first, null); // the list tells all of it
    else this.messages.invite(() => this.uploads.pick());
  }

  private listFailed(error: CurvecastError): void {
    if (error.code === "UNAUTHENTICATED" || error.code === "PERMISSION_DENIED") return this.refused(error);
    if (this.streams !== null) return; // the stream tells, and tries again
    this.messages.showBanner(`${error.message}. Trying again …`);
    clearTimeout(this.retryTimer);
    this.retryTimer = setTimeout(() => void this.refreshSessions(), 1000 * secondsBetweenTries);
  }

  private refused(error: CurvecastError): void {
    if (error.code === "PERMISSION_DENIED") return this.messages.refuse(error);
    this.messages.askToken(this.token === undefined ? null : error.message, (token) => {
      keepToken(token);
      location.reload();
    });
  }

  private choose(id: string): void {
    this.wanted = { id, camera: null };
    void this.open(id, null);
  }

  /// Shows a session once it is ready, unless another is chosen meanwhile.
  private async open(id: string, camera: CameraState | null, answer = this.client.getSession(id)): Promise<void> {
    this.isOpening = true;
    let session: Session;
    try {
      session = await answer;
    } catch (thrown) {
      const error = asCurvecastError(thrown);
      if (this.wanted?.id !== id) return;
      this.isOpening = false;
      if (error.code !== "NOT_FOUND") return this.listFailed(error);
      this.wanted = null;
      return this.messages.missingSession(id);
    }
    if (this.wanted?.id !== id) return;
    if (session.state !== SessionState.READY) {
      this.messages.showBanner(`${nameOf(session)} is being prepared …`);
      setTimeout(() => void this.open(id, camera), 1000 * secondsUntilReady);
      return;
    }
    this.wanted = null;
    this.isOpening = false;
    this.show(session, camera);
  }

  private show(session: Session, camera: CameraState | null): void {
    this.messages.hideBanner();
    this.messages.hideCard();
    this.streams?.close();
    if (this.session !== null && this.session.sessionId !== session.sessionId) this.brush.clear();
    this.session = session;
    this.streams = new Streams(this.client, session.sessionId, {
      onFrame: (frame) => this.frameCame(frame),
      onState: (state, error, delay) => this.stateChanged(state, error, delay),
    });
    document.title = `${nameOf(session)} – Curvecast`;
    const { boxMin, boxMax } = session.report?.mesh ?? {};
    if (boxMin !== undefined && boxMax !== undefined) {
      this.viewport.setBounds([boxMin.x, boxMin.y, boxMin.z], [boxMax.x, boxMax.y, boxMax.z]);
    }
    this.showStores(); // what fits depends on how many pictures there are
    if (camera !== null) this.viewport.camera = camera;
    else this.viewport.frame();
    this.change((settings) => (settings.frozen = false));
    this.look();
    this.viewport.pointsChanged();
    void this.refreshSessions();
  }

  private uploaded(session: Session, missing: readonly string[]): void {
    if (missing.length > 0) this.messages.notice(`Not among the files, and done without: ${missing.join(", ")}`);
    this.choose(session.sessionId);
  }

  private async forget(session: Session): Promise<void> {
    if (!confirm(`Forget ${nameOf(session)}, on the server too?`)) return;
    try {
      await this.client.closeSession(session.sessionId);
    } catch (thrown) {
      this.messages.failure(`${nameOf(session)} could not be forgotten`, asCurvecastError(thrown));
    }
    await this.refreshSessions();
  }

  private frameCame(frame: FrameReport): void {
    if (frame.error !== null) return this.messages.notice(`The server refused this view: ${frame.error.message}`);
    this.uploadMilliseconds = this.viewport.uploadNow();
    this.showFigures();
  }

  private stateChanged(state: LiveViewState, error: CurvecastError | null, delay: number | null): void {
    if (state === "streaming" || state === "refining") this.messages.hideBanner();
    if (state === "reconnecting" && delay !== null && delay > noticeableDelay) {
      this.messages.showBanner(`${error?.message ?? "The connection was lost"}. Trying again …`, {
        text: "Try now",
        run: () => this.streams?.main.retryNow(),
      });
    }
    if (state === "failed" && error !== null) {
      if (error.code === "UNAUTHENTICATED" || error.code === "PERMISSION_DENIED") this.refused(error);
      else if (error.code === "NOT_FOUND") this.messages.missingSession(this.session?.sessionId ?? "");
      else this.messages.failure("The stream has ended", error);
    }
    this.showFigures();
  }

  private showFigures(): void {
    this.hud.visible = this.streams !== null;
    if (this.streams !== null) this.hud.show(this.streams.main, this.viewport.framesPerSecond, this.uploadMilliseconds);
  }

  private async saveScreenshot(): Promise<void> {
    if (this.session !== null) download(await this.viewport.screenshot(), `${stemOf(this.session)}.png`);
  }

  private savePly(): void {
    if (this.session === null || this.streams === null) return;
    const { store } = this.streams.main;
    download(plyOf(store), `${stemOf(this.session)}-${store.count}.ply`);
  }

  private shortcuts() {
    const toggle = (key: "edl" | "split" | "frozen") => () => this.change((s) => (s[key] = !s[key]));
    const scalePoints = (factor: number) => () =>
      this.change((s) => {
        s.budget = "points";
        s.points = withinRange("points", Math.round(s.points * factor));
      });
    const colourings = ["shading", "normal", "curvature", "rank", "density", "colour"] as const;
    return [
      { key: "f", what: "show the whole surface", run: () => this.viewport.frame() },
      { key: "u", what: "open a mesh", run: () => this.uploads.pick() },
      { key: "1", what: "discs", run: () => this.change((s) => (s.mode = "splats")) },
      { key: "2", what: "dots", run: () => this.change((s) => (s.mode = "dots")) },
      {
        key: "c",
        what: "next colouring",
        run: () => this.change((s) => (s.colouring = colourings[(colourings.indexOf(s.colouring) + 1) % colourings.length]!)),
      },
      { key: "o", what: "eye-dome lighting", run: toggle("edl") },
      {
        key: "l",
        what: "light, dark",
        run: () => this.change((s) => (s.background = s.background === "light" ? "dark" : "light")),
      },
      { key: "[", what: "half as many points", run: scalePoints(0.5) },
      { key: "]", what: "twice as many points", run: scalePoints(2) },
      { key: "v", what: "uniform points beside", run: toggle("split") },
      { key: "z", what: "freeze the sampling camera", run: toggle("frozen") },
      { key: "b", what: "brush", run: () => this.change((s) => ((s.brush = !s.brush), (s.measuring = false))) },
      { key: "mod+z", what: "undo a stroke", run: () => this.change(() => this.brush.undo()) },
      { key: "delete", what: "clear all strokes", run: () => this.change(() => this.brush.clear()) },
      { key: "m", what: "measure", run: () => this.change((s) => ((s.measuring = !s.measuring), (s.brush = false))) },
      {
        key: "n",
        what: "orbit, fly",
        run: () => this.change((s) => (s.navigation = s.navigation === "orbit" ? "fly" : "orbit")),
      },
      { key: "p", what: "save the picture", run: () => void this.saveScreenshot() },
      { key: "x", what: "save the points as PLY", run: () => this.savePly() },
      { key: "h", what: "panel", run: () => this.panel.toggle() },
    ];
  }
}
