// Figures over the picture.

import type { LiveView, LiveViewState } from "../stream";
import { element } from "./elements";
import { bytes, count, seconds } from "./format";

const words: Record<LiveViewState, string> = {
  connecting: "connecting …",
  streaming: "live",
  refining: "refining …",
  reconnecting: "connection lost",
  failed: "ended",
};

/// Shows what it is given; asks nobody.
export class Hud {
  private readonly state = element("span", { class: "state" });
  private readonly rows = new Map<string, HTMLElement>();
  private readonly root = element("div", { class: "hud" });

  constructor(parent: HTMLElement) {
    this.root.append(this.state);
    const list = element("dl");
    for (const name of ["points", "update", "traffic", "view → points", "server", "frames", "curve"]) {
      const value = element("dd", { text: "–" });
      this.rows.set(name, value);
      list.append(element("dt", { text: name }), value);
    }
    this.root.append(list);
    parent.append(this.root);
  }

  set visible(visible: boolean) {
    this.root.hidden = !visible;
  }

  show(view: LiveView, framesPerSecond: number, uploadMilliseconds: number): void {
    const { last, viewP50, viewP99, bytesPerSecond } = view.statistics();
    this.state.textContent = words[view.state];
    this.state.dataset.state = view.state;
    this.set("points", count(view.store.count));
    this.set("view → points", `${seconds(viewP50)}, p99 ${seconds(viewP99)}`);
    this.set("frames", `${framesPerSecond.toFixed(0)} per second, upload ${uploadMilliseconds.toFixed(1)} ms`);
    this.set("traffic", `${bytes(bytesPerSecond)} per second`);
    if (last === null) return;
    const resized = last.resized > 0 ? ` ~${count(last.resized)}` : "";
    this.set("update", `+${count(last.added)} −${count(last.removed)}${resized}, ${bytes(last.bytes)}`);
    this.set("server", `${seconds(last.serverSeconds)}, decoding ${seconds(last.decodeSeconds)}`);
    this.set("curve", `${count(last.curveVertices)} vertices, revision ${last.curveRevision}`);
  }

  private set(name: string, text: string): void {
    const row = this.rows.get(name)!;
    if (row.textContent !== text) row.textContent = text;
  }
}
