// SPDX-License-Identifier: Apache-2.0
// The figures over the picture.

import type { LiveViewState } from "../stream";
import { element } from "./elements";
import type { Measured, MeasureKind } from "../view";
import { angle, area, bytes, count, length, seconds, type Unit } from "./format";
import type { MeshFollower } from "./mesh_follower";
import { pointsText } from "./points_text";
import type { Streams } from "./streams";

const words: Record<LiveViewState, string> = {
  connecting: "connecting …",
  streaming: "live",
  refining: "refining …",
  reconnecting: "connection lost",
  failed: "ended",
};

/// Rows that only streams have figures for.
const ofStreams = ["update", "traffic", "view → points", "server", "curve"];

const measures: readonly MeasureKind[] = ["distance", "angle", "area"];

const framesText = (perSecond: number): string => (perSecond > 0 ? `${perSecond.toFixed(0)} per second` : "–");

/// Which revision a curve is: of its number what counts, without what tells servers' curves apart.
function revisionText(revision: number): string {
  return (revision < 0x10000 ? revision : Math.floor(revision / 0x10000)).toString();
}

/// Shows the figures of the streams. Folded, it shows the state alone.
export class Hud {
  private readonly state = element("span", { class: "state" });
  private measuredNow: Measured | null = null;
  private unitNow: Unit = "none";
  private hasSurface = false;
  private readonly rows = new Map<string, HTMLElement>();
  private readonly root = element("details", { class: "hud", attributes: { "aria-label": "Figures" } });

  constructor(parent: HTMLElement) {
    this.root.open = true;
    this.root.append(element("summary", { title: "Fold or unfold the figures (I)" }, [this.state]));
    const list = element("dl");
    const asked = ["surface", "mesh", ...measures]; // rows that are shown while there is something in them
    for (const name of ["points", "update", "traffic", "view → points", "server", "frames", "curve", ...asked]) {
      const kind = asked.includes(name) ? { class: `asked ${name}` } : {};
      const value = element("dd", { text: "–", ...kind });
      this.rows.set(name, value);
      list.append(element("dt", { text: name, ...kind }), value);
    }
    this.root.append(list);
    this.showMeasured();
    this.showMesh(null);
    this.showSurface(null);
    parent.append(this.root);
  }

  set visible(visible: boolean) {
    this.root.hidden = !visible;
  }

  toggle(): void {
    this.root.open = !this.root.open;
  }

  /// Shows what was measured; null hides the row.
  set measured(measured: Measured | null) {
    this.measuredNow = measured;
    this.showMeasured();
    if (measured !== null) this.root.open = true;
  }

  set unit(unit: Unit) {
    this.unitNow = unit;
    this.showMeasured();
  }

  /// Shows the figures of the mesh; null hides the row.
  showMesh(follower: MeshFollower | null): void {
    if (follower === null) return this.setAsked("mesh", null);
    const { mesh, isCurrent, seconds: time } = follower;
    const figures = mesh === null ? [] : [`${count(mesh.vertices.count)} vertices in ${seconds(time)}`];
    this.setAsked("mesh", [...figures, ...(isCurrent ? [] : ["…"])].join(" "));
  }

  /// Shows what is drawn instead of the points; null hides the row.
  showSurface(text: string | null): void {
    this.hasSurface = text !== null;
    this.setAsked("surface", text);
  }

  /// Shows the figures of a file's points instead of those of streams. `isShown`: there is such a file.
  showFile(isShown: boolean, points: number, framesPerSecond: number): void {
    for (const name of ofStreams) this.hide(name, isShown);
    if (!isShown) return;
    this.state.textContent = "point cloud from a file";
    this.state.dataset.state = "streaming";
    this.set("points", count(points));
    this.set("frames", framesText(framesPerSecond));
  }

  /// Shows the figures of the moment. `framesPerSecond`: 0 where nothing moves.
  show(streams: Streams, framesPerSecond: number, uploadMilliseconds: number): void {
    const view = streams.main;
    const { last, viewP50, viewP99 } = view.statistics();
    const state = view.lastLook === 0 && this.hasSurface ? "streaming" : view.state; // no points were asked for
    this.state.textContent = words[state];
    this.state.dataset.state = state;
    this.set("points", pointsText(view.store.count, last));
    this.set("view → points", `${seconds(viewP50)}, p99 ${seconds(viewP99)}`);
    this.set("frames", `${framesText(framesPerSecond)}, upload ${uploadMilliseconds.toFixed(1)} ms`);
    this.set("traffic", `${bytes(streams.bytesPerSecond)} per second`);
    if (last === null) return;
    const resized = last.resized > 0 ? ` ~${count(last.resized)}` : "";
    this.set("update", `+${count(last.added)} −${count(last.removed)}${resized}, ${bytes(last.bytes)}`);
    this.set("server", `${seconds(last.serverSeconds)}, decoding ${seconds(last.decodeSeconds)}`);
    this.set("curve", `${count(last.curveVertices)} vertices, revision ${revisionText(last.curveRevision)}`);
  }

  private showMeasured(): void {
    const { measuredNow, unitNow } = this;
    const text = measuredNow && { distance: length, area, angle }[measuredNow.kind](measuredNow.value, unitNow);
    for (const kind of measures) this.setAsked(kind, measuredNow?.kind === kind ? text : null);
  }

  private setAsked(name: string, text: string | null): void {
    this.hide(name, text === null);
    if (text !== null) this.set(name, text);
  }

  private hide(name: string, isHidden: boolean): void {
    const row = this.rows.get(name)!;
    row.hidden = (row.previousElementSibling as HTMLElement).hidden = isHidden;
  }

  private set(name: string, text: string): void {
    const row = this.rows.get(name)!;
    if (row.textContent !== text) row.textContent = text;
  }
}
