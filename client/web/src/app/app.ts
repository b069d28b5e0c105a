// SPDX-License-Identifier: Apache-2.0
// The viewer's page: joins its parts.

import type { Cloud } from "../cloud";
import type { FrameReport, Session } from "../stream";
import { directionOf, Viewport, type CameraState, type StandardView } from "../view";
import { AxesGizmo } from "./axes_gizmo";
import type { Begun } from "./begin";
import { Brush } from "./brush";
import { beginCloud, CloudView, settleForCloud } from "./cloud_view";
import { DrawingBudget } from "./drawing_budget";
import type { ListedPoints } from "./export_ply";
import { Film } from "./film/film";
import { Hud } from "./hud";
import { keyTable } from "./key_table";
import { Annotations } from "./marks/annotations";
import { MeshFollower } from "./mesh_follower";
import { Messages } from "./messages";
import { copyText, toggleFullScreen } from "./page_tools";
import { Panel } from "./panel";
import { meshRequest, sampleRequest, type SampleInit } from "./sample_request";
import { saveFilm, saveMesh, savePicture, savePoints } from "./saving";
import { ScaleBar } from "./scale_bar";
import { SessionChoice } from "./session_choice";
import { forgetSession, nameOf, SessionList } from "./session_list";
import { defaultSettings, takeCamera, type Settings } from "./settings";
import { Shortcuts } from "./shortcuts";
import { Streams } from "./streams";
import { SurfaceView } from "./surface_view";
import { tabStorage, Thumbnails, thumbnailSize } from "./thumbnails";
import { Troubles } from "./troubles";
import { Uploads } from "./upload";
import { readState, writeState } from "./url_state";
import { ViewPacer } from "./view_pacer";
import { applyView, brushRadiusOf, styleOf } from "./view_settings";

const titleOf = (name: string): string => `${name} – Curvecast`;
const secondsBeforeSave = 0.4; // that the address waits after the last change
const longestStart = 500; // ms that the first picture waits for points
/// The application, of which a page has one. Throws NoWebGL2Error.
export class Application {
  readonly settings: Settings;
  readonly viewport: Viewport;
  streams: Streams | null = null;
  session: Session | null = null;
  mesh: MeshFollower | null = null; // of the session
  readonly surface: SurfaceView;
  readonly cloud: CloudView;
  private readonly defaults: Settings;
  private readonly panel: Panel;
  private readonly hud: Hud;
  private readonly list: SessionList;
  readonly uploads: Uploads;
  private readonly axes: AxesGizmo;
  private readonly scale: ScaleBar;
  private readonly brush: Brush;
  readonly annotations: Annotations;
  private readonly thumbnails = new Thumbnails(tabStorage());
  private readonly drawingBudget = new DrawingBudget();
  private readonly film: Film;
  private readonly choice: SessionChoice;
  private readonly troubles: Troubles;
  private frozen: { camera: CameraState; size: { width: number; height: number } } | null = null;
  private shown: unknown[] = []; // the stores that the viewport draws
  private preview: Session | null = null; // a stand-in, of which there are points but no meshes
  private isPainting = false; // a stroke of the brush is under way
  private readonly pacer = new ViewPacer(
    () => this.look(),
    () => this.viewport.isDrawing,
  );
  private saveTimer: ReturnType<typeof setTimeout> | undefined;
  private uploadMilliseconds = 0;

  constructor(
    canvas: HTMLCanvasElement,
    page: HTMLElement,
    readonly messages: Messages,
    private readonly begun: Begun,
  ) {
    this.viewport = new Viewport(canvas);
    this.viewport.expectPoints(longestStart); // an empty picture would take the processor's time from them
    this.defaults = defaultSettings(
      this.viewport.isSoftware,
      matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light",
    );
    const { session, camera, settings } = readState(location.hash, this.defaults);
    this.settings = { ...this.defaults, dabs: [], marks: [], ...settings };
    this.brush = new Brush(this.settings, (text) => this.messages.notice(text));
    const events = { changed: () => this.surfaceCame(), notice: (text: string): void => this.messages.notice(text) };
    this.surface = new SurfaceView(begun.client, this.viewport, this.defaults, events);
    this.cloud = new CloudView(this.viewport, messages);
    this.troubles = new Troubles(this, messages, begun);
    this.annotations = new Annotations(page, this.settings.marks, {
      viewport: this.viewport,
      changed: () => this.saveSoon(),
      notice: (text) => this.messages.notice(text),
    });
    const isAnswered = (): boolean => !this.surface.needsPoints || this.streams?.isAnswered !== false;
    this.film = new Film(this.viewport, messages, () => !this.pacer.isWaiting && isAnswered(), this.annotations.draw);
    this.hud = new Hud(page);
    this.axes = new AxesGizmo(page, (direction) => this.viewport.lookFrom(direction, this.settings.up));
    this.scale = new ScaleBar(page);
    const listed = {
      open: (chosen: Session) => this.choice.choose(chosen.sessionId),
      forget: (chosen: Session) => void this.forget(chosen),
    };
    this.list = new SessionList(listed, this.thumbnails);
    this.uploads = new Uploads(page, this.begun.client, {
      onPreview: (preview) => this.previewed(preview),
      onReady: (ready, missing) => this.uploaded(ready, missing),
      onCloud: (name, cloud) => this.showCloud(name, cloud),
      onFailure: (what, error) => this.messages.failure(what, error),
    });
    const actions = {
      upload: () => this.uploads.pick(),
      fit: () => this.viewport.frame(),
      view: (name: StandardView) => this.viewport.lookFrom(directionOf(name, this.settings.up), this.settings.up),
      fullScreen: () => void toggleFullScreen(this.messages),
      copyLink: () => void this.copyLink(),
      undoStroke: () => this.change(() => this.brush.undo()),
      clearStrokes: () => this.change(() => this.brush.clear()),
      screenshot: () => void savePicture(this, this.settings.pictureScale),
      film: () => void saveFilm(this, this.film.make(this.settings.filmSeconds)),
      addFilmView: () => this.film.addView(),
      clearFilmViews: () => this.film.clearViews(),
      exportPly: () => savePoints(this),
      exportMesh: () => saveMesh(this),
      addMark: () => this.annotations.addInTheMiddle(),
      clearMarks: () => this.annotations.clear(),
    };
    const say = (text: string): void => this.messages.say(text);
    const toggles = { say, togglePanel: () => this.panel.toggle(), toggleFigures: () => this.hud.toggle() };
    const shortcuts = new Shortcuts(page, keyTable({ ...actions, change: (how) => this.change(how), ...toggles }));
    this.panel = new Panel(
      document.body, // beside the page's main part
      this.settings,
      { ...actions, changed: () => this.changed(), help: () => shortcuts.toggleHelp() },
      { sessions: this.list.root, marks: this.annotations.root },
    );
    this.choice = this.makeChoice();
    this.listen();
    this.axes.show(this.viewport.camera);
    this.changed();
    this.choice.start(begun.answers, session, camera);
  }

  private makeChoice(): SessionChoice {
    const { messages } = this;
    return new SessionChoice(
      this.begun.client,
      {
        onSessions: (sessions) => this.list.show(sessions),
        onReady: (session, camera) => this.show(session, camera),
        onNone: () => messages.invite(() => this.uploads.pick()),
        onWaiting: (text) => messages.setBanner("session", text),
        onFailure: (id, error) => this.troubles.failed(id, error),
        onRefused: (error) => this.troubles.refused(error),
      },
      () => !document.hidden,
    );
  }

  private listen(): void {
    this.viewport.onCamera = () => this.cameraMoved();
    this.viewport.onPicture = ({ points, milliseconds, isFine }) => {
      const { budget, frameMilliseconds } = this.settings;
      if (points > 0 || this.surface.shown !== null) this.begun.poster.hide();
      if (isFine && budget === "automatic" && points > 0 && this.drawingBudget.note(points, milliseconds, frameMilliseconds))
        this.pacer.request();
    };
    this.viewport.onDrawn = () => this.pacer.drawn();
    this.viewport.onBrush = (centre, done) => {
      this.isPainting = !done;
      if (this.brush.paint(centre, brushRadiusOf(this.settings, this.viewport.bounds), done) || done) this.changed();
    };
    this.viewport.onMeasure = (measured) => (this.hud.measured = measured);
    const lost = "The graphics card was lost; the picture waits until it is back …";
    this.viewport.onLost = (isLost) => this.messages.setBanner("graphics", isLost ? lost : null);
    this.viewport.onResize = () => this.cameraMoved(); // the scale changes
    window.addEventListener("hashchange", () => location.reload());
    setInterval(() => this.showFigures(), 250);
  }

  private cameraMoved(): void {
    const { camera } = this.viewport;
    this.axes.show(camera);
    this.annotations.place();
    if (this.name !== null) this.scale.show(camera, this.viewport.cssSize.height);
    if (takeCamera(this.settings, camera)) this.panel.refresh();
    this.pacer.request();
  }

  /// Applies settings that have changed.
  private changed(): void {
    const { settings, viewport } = this;
    if (this.cloud.store !== null) settleForCloud(settings);
    document.documentElement.dataset.theme = settings.background;
    document.body.classList.toggle("split", settings.split && this.session !== null);
    this.applyStyle();
    applyView(settings, viewport);
    viewport.onClick = settings.marking && !settings.brush ? (place) => this.annotations.add(place) : null;
    viewport.setMeasuring(settings.measuring && !settings.brush && !settings.marking ? settings.measure : null);
    this.scale.unit = this.hud.unit = settings.unit;
    this.isPainting &&= settings.brush; // a stroke also ends with the brush
    viewport.setBrush(settings.brush && this.session !== null ? brushRadiusOf(this.settings, this.viewport.bounds) : null);
    if (settings.frozen !== (this.frozen !== null)) {
      this.frozen = settings.frozen ? { camera: viewport.camera, size: viewport.size } : null;
    }
    viewport.frozenCamera = this.frozen && {
      camera: this.frozen.camera,
      aspect: this.frozen.size.width / this.frozen.size.height,
      isCut: settings.frustum,
      isEven: settings.screen,
    };
    this.pacer.request();
  }

  private applyStyle(onlyIfOther = false): void {
    const { settings, surface, streams, viewport } = this;
    const isOther = surface.follow(settings, streams?.main.statistics().bytes ?? 0, this.session !== this.preview);
    if (onlyIfOther && !isOther) return;
    viewport.style = styleOf(settings, surface.modeOf(settings), () => this.brush.trace(), viewport.bounds);
  }

  /// Changes settings, and shows them in the panel.
  private change(how: (settings: Settings) => void): void {
    how(this.settings);
    this.panel.refresh();
    this.changed();
  }

  private look(): void {
    const { streams, settings, viewport } = this;
    if (streams === null) return;
    this.applyStyle(true); // more bytes of points may have come
    this.showStores();
    const camera = this.frozen?.camera ?? viewport.camera;
    const size = this.frozen?.size ?? viewport.size;
    const ask = (isUniform: boolean): SampleInit => sampleRequest(settings, camera, size, isUniform, this.drawingBudget.mostPoints);
    if ((this.surface.needsPoints || settings.split) && streams.look(ask(false), ask(true))) viewport.expectPoints();
    const hasMesh = settings.wireframe && this.session !== this.preview;
    this.mesh?.follow(hasMesh ? meshRequest(settings, camera, size) : null, this.isPainting);
    this.saveSoon();
  }

  /// Has the viewport draw the store of the main stream, or that of the uniform stream, too, in a split view.
  private showStores(): void {
    if (this.streams === null) return;
    this.streams.split(this.settings.split);
    const { main, uniform } = this.streams;
    if (uniform === null) this.messages.hideBanner("uniform");
    const stores = uniform === null ? [main.store] : [uniform.store, main.store];
    if (stores.length === this.shown.length && stores.every((store, i) => store === this.shown[i])) return;
    this.shown = stores;
    this.viewport.setStores(stores[0]!, stores[1]);
  }

  private saveSoon(): void {
    clearTimeout(this.saveTimer);
    this.saveTimer = setTimeout(() => this.save(), 1000 * secondsBeforeSave);
  }

  private save(): void {
    if (this.session === null) return;
    history.replaceState(null, "", writeState(this.session.sessionId, this.viewport.camera, this.settings, this.defaults));
  }

  private async copyLink(): Promise<void> {
    if (this.cloud.store !== null) return this.messages.notice("A link cannot hold points that are shown from their file");
    this.save();
    if (await copyText(location.href, "The address of this view")) this.messages.notice("The link to this view was copied");
  }

  /// The name of the file that is shown; null: nothing is.
  get name(): string | null {
    return this.cloud.name ?? (this.session && nameOf(this.session));
  }

  /// The points that are shown, or would be without the surface's triangles.
  get points(): ListedPoints | null {
    return this.cloud.store ?? this.streams?.main.store ?? null;
  }

  /// Ends what is shown for a session, or for something else.
  private leaveFor(next: Session | null): void {
    for (const which of ["main", "uniform"] as const) this.messages.hideBanner(which);
    this.messages.hideCard();
    this.messages.hideHint();
    this.streams?.close();
    this.mesh?.follow(null, false);
    this.streams = null; // what is next is not asked for views of the camera before
    this.shown = [];
    const isSame = next !== null && this.session?.sessionId === next.sessionId;
    if (this.session !== null && !isSame)
      this.thumbnails.keep(this.session.sessionId, this.viewport.thumbnail(thumbnailSize.width, thumbnailSize.height));
    if (!isSame && (this.name !== null || next === null)) {
      this.brush.clear();
      this.annotations.clear();
      this.film.clearViews();
    }
    this.cloud.close();
    this.session = next;
    this.list.current = next?.sessionId ?? null;
    this.panel.isOfSession = next !== null;
    this.viewport.forgetMeasured();
  }

  private showCloud(name: string, cloud: Cloud): void {
    this.leaveFor(null);
    this.choice.rest();
    this.surface.close();
    this.mesh = null;
    document.title = titleOf(name);
    this.cloud.open(name, cloud);
    this.change((settings) => beginCloud(settings, name, cloud));
    this.viewport.pointsChanged();
    this.showFigures();
  }

  private show(session: Session, camera: CameraState | null): void {
    this.leaveFor(session);
    this.surface.open(session);
    document.title = titleOf(nameOf(session));
    const { boxMin, boxMax } = session.report?.mesh ?? {};
    if (boxMin !== undefined && boxMax !== undefined) {
      this.viewport.setBounds([boxMin.x, boxMin.y, boxMin.z], [boxMax.x, boxMax.y, boxMax.z]);
    }
    this.change((settings) => (settings.frozen = false));
    this.streams = new Streams(this.begun.client, session, {
      onFrame: (frame) => this.frameCame(frame),
      onState: (...change) => {
        this.troubles.stateChanged(...change);
        this.showFigures();
      },
    });
    this.mesh = new MeshFollower((sample, options) => this.begun.client.remesh(session.sessionId, sample, options), {
      onMesh: (mesh) => this.viewport.setWireframe(mesh),
      onFailure: (error) => this.messages.notice(`The mesh cannot be made: ${error.message}`),
    });
    this.showStores(); // first: how much fits into a picture depends on the number of pictures
    if (camera !== null) this.viewport.camera = camera;
    else this.viewport.frame();
    this.look();
    this.viewport.pointsChanged();
  }

  private previewed(preview: Session): void {
    this.preview = preview;
    this.choice.showNow(preview);
    this.messages.notice("A coarse preview; the rest follows by itself");
  }

  private uploaded(session: Session, missing: readonly string[]): void {
    if (missing.length > 0) this.messages.notice(`Not among the files, and done without: ${missing.join(", ")}`);
    if (this.session?.sessionId === session.sessionId && this.streams?.main.state !== "failed") {
      if (this.session === this.preview) this.surface.open(session);
      this.session = session; // its preview is shown, and its stream goes on by itself
      this.pacer.request(); // there may be a mesh now
      this.choice.refresh();
      return;
    }
    this.choice.choose(session.sessionId);
  }

  private async forget(session: Session): Promise<void> {
    if (await forgetSession(this.begun.client, session, this.messages)) this.choice.refresh();
  }

  private frameCame(frame: FrameReport): void {
    if (frame.error !== null) return this.troubles.refusedView(frame.error);
    this.messages.hideHint();
    const isChanged = frame.added + frame.removed + frame.resized > 0;
    if (isChanged) {
      this.uploadMilliseconds = this.viewport.uploadNow();
      this.annotations.place();
    } else this.viewport.expectNoPoints();
    this.showFigures();
  }

  /// The surface's triangles have come, or will not.
  private surfaceCame(): void {
    this.applyStyle();
    this.viewport.pointsChanged();
    this.annotations.place();
    if (this.surface.shown !== null) this.messages.hideHint();
    this.pacer.request();
  }

  private showFigures(): void {
    const { store } = this.cloud;
    this.hud.visible = this.streams !== null || store !== null;
    this.hud.showFile(store !== null, store?.count ?? 0, this.viewport.framesPerSecond);
    this.hud.showSurface(this.surface.text);
    if (this.streams !== null) this.hud.show(this.streams, this.viewport.framesPerSecond, this.uploadMilliseconds);
    this.hud.showMesh(this.settings.wireframe ? this.mesh : null);
  }
}
