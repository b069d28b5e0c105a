// SPDX-License-Identifier: Apache-2.0
// The custom element <curvecast-view>.

import { asCurvecastError, CurvecastError, type FrameReport, type Session } from "../stream";
import { NoWebGL2Error, type CameraState } from "../view/types";
import { observedAttributes, sessionSource, type SessionSource } from "./element_source";
import { MessageLine } from "./message_line";
import { SessionView } from "./session_view";
import { style } from "./style";

/// The events of an element, besides those that all elements have. They do not bubble.
export interface CurvecastViewEvents {
  /// The first points of a session are in the picture.
  ready: CustomEvent<Session>;
  /// A frame of points has come, or the server has refused a view: see FrameReport.error.
  frame: CustomEvent<FrameReport>;
  /// Something is wrong, which the element says in words, too. It tries again where that may help: then there may be more of them.
  error: CustomEvent<CurvecastError>;
}

type Listener<Type extends keyof CurvecastViewEvents> = (this: CurvecastView, event: CurvecastViewEvents[Type]) => unknown;

// A module that is loaded where there are no pages, to make their HTML, defines nothing.
const Base = (globalThis as { HTMLElement?: typeof HTMLElement }).HTMLElement ?? (Object as unknown as typeof HTMLElement);

const usualLabel = "The surface: arrows turn it, + and − go nearer and farther";

/// Shows a session of a server, and lets the visitor turn it. Streams while it is in a page. Attributes:
///   src         address of the server, or of a view of its viewer: what is after # counts, too, the viewer's tools apart
///   token       that the server asks for; session: id; points, mode, colouring, background: as in the viewer's address. They stand
///               above what src has.
///   aria-label  what those hear who do not see the picture
/// Attributes may change at any time.
export class CurvecastView extends Base {
  static readonly observedAttributes: readonly string[] = [...observedAttributes, "aria-label"];

  private readonly message = new MessageLine();
  private shown: SessionView | null = null;
  private canvas: HTMLCanvasElement | null = null;
  private isDue = false; // a change of attributes

  constructor() {
    super();
    const sheet = new CSSStyleSheet();
    sheet.replaceSync(style);
    const root = this.attachShadow({ mode: "open", delegatesFocus: true });
    root.adoptedStyleSheets = [sheet];
    root.append(this.message.root);
    // The page scrolls past the picture until a visitor has pressed it.
    const passUnlessFocused = (event: WheelEvent): void => {
      if (root.activeElement === null && !event.ctrlKey) event.stopPropagation();
    };
    this.addEventListener("wheel", passUnlessFocused, { capture: true, passive: true });
  }

  /// The session that is shown; null until it is known.
  get session(): Session | null {
    return this.shown?.session ?? null;
  }

  /// The camera, in the units and the frame of the mesh's file; null while the element is in no page.
  get camera(): CameraState | null {
    return this.shown?.viewport.camera ?? null;
  }

  set camera(camera: CameraState | null) {
    if (this.shown !== null && camera !== null) this.shown.viewport.camera = camera;
  }

  /// Shows the whole surface, from the side that the camera is on.
  fit(): void {
    this.shown?.viewport.frame();
  }

  /// Returns the picture as a PNG, with `scale` times as many pixels in each direction. Rejects while there is none.
  async screenshot(scale = 1): Promise<Blob> {
    if (this.shown === null) throw new Error("The element shows nothing.");
    return this.shown.viewport.screenshot(scale);
  }

  connectedCallback(): void {
    this.restart();
  }

  disconnectedCallback(): void {
    this.leave();
  }

  attributeChangedCallback(): void {
    if (this.isDue) return;
    this.isDue = true;
    queueMicrotask(() => {
      this.isDue = false; // several attributes at once are one change
      this.attributesChanged();
    });
  }

  override addEventListener<Type extends keyof CurvecastViewEvents>(
    type: Type,
    listener: Listener<Type>,
    options?: boolean | AddEventListenerOptions,
  ): void;
  override addEventListener<Type extends Exclude<keyof HTMLElementEventMap, keyof CurvecastViewEvents>>(
    type: Type,
    listener: (this: HTMLElement, event: HTMLElementEventMap[Type]) => unknown,
    options?: boolean | AddEventListenerOptions,
  ): void;
  override addEventListener(
    type: string,
    listener: EventListenerOrEventListenerObject,
    options?: boolean | AddEventListenerOptions,
  ): void;
  override addEventListener(
    type: string,
    listener: EventListenerOrEventListenerObject,
    options?: boolean | AddEventListenerOptions,
  ): void {
    super.addEventListener(type, listener, options);
  }

  private readonly attributeOf = (name: string): string | null => this.getAttribute(name);

  private attributesChanged(): void {
    if (!this.isConnected) return;
    this.canvas?.setAttribute("aria-label", this.getAttribute("aria-label") ?? usualLabel);
    const source = this.readSource();
    const isSame = this.shown !== null && JSON.stringify(source) === JSON.stringify(this.shown.source);
    if (isSame) this.shown?.attributesChanged();
    else this.restart(source);
  }

  /// Returns null where there is nothing to show, an error where it cannot be understood what.
  private readSource(): SessionSource | CurvecastError | null {
    if (!this.hasAttribute("src")) return null;
    try {
      return sessionSource(this.attributeOf, document.baseURI);
    } catch (thrown) {
      return new CurvecastError("INVALID_ARGUMENT", (thrown as Error).message);
    }
  }

  private restart(source = this.readSource()): void {
    this.leave();
    this.message.clear();
    if (source instanceof CurvecastError) this.fail(source);
    else if (source !== null) this.open(source);
  }

  private open(source: SessionSource): void {
    const canvas = document.createElement("canvas");
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "application");
    canvas.setAttribute("aria-label", this.getAttribute("aria-label") ?? usualLabel);
    this.shadowRoot!.prepend(canvas);
    this.canvas = canvas;
    const tell = (type: keyof CurvecastViewEvents, detail: unknown): void =>
      void this.dispatchEvent(new CustomEvent(type, { detail }));
    try {
      this.shown = new SessionView(source, this.attributeOf, canvas, this.message, {
        onReady: (session) => tell("ready", session),
        onFrame: (frame) => tell("frame", frame),
        onError: (error) => tell("error", error),
      });
    } catch (thrown) {
      if (!(thrown instanceof NoWebGL2Error)) throw thrown;
      this.leave();
      this.fail(asCurvecastError(thrown));
      return;
    }
    canvas.style.touchAction = "pan-y"; // a finger that goes up or down scrolls the page
  }

  private leave(): void {
    this.shown?.close();
    this.shown = null;
    this.canvas?.remove();
    this.canvas = null;
  }

  private fail(error: CurvecastError): void {
    this.message.say("failure", error.message);
    this.dispatchEvent(new CustomEvent("error", { detail: error }));
  }
}
