// SPDX-License-Identifier: Apache-2.0
// A film of the surface: each picture waits for its own points, so that a slow line or machine makes no worse a film.

import { asCurvecastError } from "../../stream";
import { copyTo, type CameraState, type DrawOver, type Viewport } from "../../view";
import type { Messages } from "../messages";
import { passing, turned } from "./camera_path";
import { WebmWriter } from "./webm";

const picturesPerSecond = 30;

const longestAnswer = 5000; // ms that a picture waits for its points: then what there is has to do

const nextFrame = (): Promise<unknown> => new Promise((resolve) => requestAnimationFrame(resolve));

/// Films a turn about the surface, or the way past views that were kept.
export class Film {
  private views: CameraState[] = [];
  private making: AbortController | null = null; // the film that is being made

  /// `isAnswered`: whether the points of the newest view are there. `drawOver` draws over the picture of the moment.
  constructor(
    private readonly viewport: Viewport,
    private readonly messages: Messages,
    private readonly isAnswered: () => boolean,
    private readonly drawOver: DrawOver,
  ) {}

  /// Keeps the view of the moment: the film passes it.
  addView(): void {
    const { viewport, messages } = this;
    this.views.push(viewport.camera);
    messages.notice(
      this.views.length === 1
        ? "The film begins here; one more view at least, or it is a turn"
        : `The film passes ${this.views.length} views`,
    );
  }

  /// Forgets all views: the film is a turn again.
  clearViews(): void {
    this.views = [];
  }

  /// Makes a film, and returns it; null where the user has stopped it, it failed, or one is being made. The camera comes back.
  async make(seconds: number): Promise<Blob | null> {
    if (this.making !== null) return null;
    const { viewport, messages } = this;
    const before = viewport.camera;
    const making = (this.making = new AbortController());
    const press = (event: KeyboardEvent): void => {
      if (event.key === "Escape") making.abort();
    };
    window.addEventListener("keydown", press);
    try {
      return await this.record(before, seconds, making);
    } catch (thrown) {
      messages.failure("The film cannot be made", asCurvecastError(thrown));
      return null;
    } finally {
      window.removeEventListener("keydown", press);
      this.making = null;
      messages.hideBanner("film");
      viewport.camera = before;
    }
  }

  private async record(from: CameraState, seconds: number, making: AbortController): Promise<Blob | null> {
    const { viewport, messages } = this;
    const even = (side: number): number => Math.max(2, side - (side % 2));
    const canvas = document.createElement("canvas");
    const { width, height } = viewport.size;
    [canvas.width, canvas.height] = [even(width), even(height)];
    const context = canvas.getContext("2d")!;
    const writer = await WebmWriter.open(canvas, picturesPerSecond);
    const count = Math.max(2, Math.round(seconds * picturesPerSecond));
    const views = this.views;
    for (let i = 0; i < count; ++i) {
      if (making.signal.aborted) {
        await writer.cancel();
        return null;
      }
      if (i % 10 === 0) {
        messages.showBanner("film", `Filming: picture ${i + 1} of ${count}`, { text: "Stop", run: () => making.abort() });
      }
      viewport.camera = views.length > 1 ? passing(views, i / (count - 1)) : turned(from, i / count);
      await this.untilAnswered();
      copyTo(context, viewport.still(), viewport.cssSize.width, this.drawOver);
      await writer.add();
    }
    return writer.finish();
  }

  private async untilAnswered(): Promise<void> {
    const end = performance.now() + longestAnswer;
    // Views leave the page with its next frame.
    for (let frames = 0; frames < 2 || (!this.isAnswered() && performance.now() < end); ++frames) await nextFrame();
  }
}
