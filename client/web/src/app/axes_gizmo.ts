// SPDX-License-Identifier: Apache-2.0
// The axes of the mesh's file in a corner of the picture, as the camera sees them.

import type { CameraState, Vec } from "../view";
import { cameraAxes } from "../view/camera_math";
import { dot } from "../view/vector";

const space = "http://www.w3.org/2000/svg";
const reach = 34; // of an axis, in the 100 units of the drawing's sides
const axes: readonly (readonly [name: string, direction: Vec])[] = [
  ["x", [1, 0, 0]],
  ["y", [0, 1, 0]],
  ["z", [0, 0, 1]],
];

function svg(tag: string, attributes: Record<string, string>, children: readonly Node[] = []): SVGElement {
  const made = document.createElementNS(space, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

/// One end of an axis.
interface Tip {
  direction: Vec;
  group: SVGElement;
  line: SVGElement | null; // of a positive end
}

/// Draws the axes. A click on the end of one has the camera look from there. The panel has buttons for those who do not point.
export class AxesGizmo {
  private readonly root = svg("svg", { class: "axes", viewBox: "-50 -50 100 100", "aria-hidden": "true" });
  private readonly tips: Tip[];

  constructor(parent: HTMLElement, lookFrom: (direction: Vec) => void) {
    this.tips = axes.flatMap(([name, direction]) =>
      [1, -1].map((sign): Tip => {
        const towards = direction.map((value) => sign * value) as Vec;
        const end = svg("circle", { r: sign > 0 ? "11" : "7" });
        const letter = svg("text", {}, [document.createTextNode(name.toUpperCase())]);
        const label = svg("title", {}, [document.createTextNode(`Look from ${sign > 0 ? "+" : "−"}${name.toUpperCase()}`)]);
        const group = svg("g", { class: `${name} ${sign > 0 ? "positive" : "negative"}` }, [
          end,
          ...(sign > 0 ? [letter] : []),
          label,
        ]);
        group.addEventListener("click", () => lookFrom(towards));
        return { direction: towards, group, line: sign > 0 ? svg("line", { class: name }) : null };
      }),
    );
    parent.append(this.root);
  }

  /// Draws the axes for a camera: those that point at the eye last.
  show(camera: CameraState): void {
    const { right, up, forward } = cameraAxes(camera);
    const depth = ({ direction }: Tip): number => dot(direction, forward);
    for (const { direction, group, line } of this.tips) {
      const [x, y] = [reach * dot(direction, right), -reach * dot(direction, up)];
      group.setAttribute("transform", `translate(${x.toFixed(1)} ${y.toFixed(1)})`);
      line?.setAttribute("x2", x.toFixed(1));
      line?.setAttribute("y2", y.toFixed(1));
    }
    const ordered = [...this.tips].sort((a, b) => depth(b) - depth(a));
    this.root.replaceChildren(...ordered.flatMap(({ line, group }) => (line === null ? [group] : [line, group])));
  }
}
