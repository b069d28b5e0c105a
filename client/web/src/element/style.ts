// SPDX-License-Identifier: Apache-2.0
// The style within an element. What the page sets for the element itself stands above :host.

export const style = `
:host {
  display: block;
  position: relative;
  height: 24rem;
  overflow: hidden;
  contain: layout paint;
}
:host([hidden]) {
  display: none;
}
canvas {
  display: block;
  width: 100%;
  height: 100%;
  outline: none;
}
canvas:focus-visible {
  outline: 2px solid Highlight;
  outline-offset: -2px;
}
p {
  position: absolute;
  inset: auto 0.5rem 0.5rem;
  width: fit-content;
  max-width: calc(100% - 1rem);
  box-sizing: border-box;
  margin: 0 auto;
  padding: 0.4em 0.8em;
  border-radius: 0.4em;
  background: Canvas;
  color: CanvasText;
  font: 0.875rem / 1.4 system-ui, sans-serif;
  overflow-wrap: anywhere;
}
p[hidden],
button[hidden] {
  display: none;
}
button {
  margin-inline-start: 0.8em;
  font: inherit;
}
`;
