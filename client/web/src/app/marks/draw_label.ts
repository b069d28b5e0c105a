// SPDX-License-Identifier: Apache-2.0
// Labels of annotations in saved pictures and films, as the page's style has them.

/// Breaks a text into lines of a width at most: between words where it can, within them where it has to.
export function linesOf(text: string, width: number, measure: (part: string) => number): string[] {
  const lines: string[] = [];
  let line = "";
  for (const word of text.split(/(?<=\s)/)) {
    if (line !== "" && measure((line + word).trimEnd()) > width) {
      lines.push(line.trimEnd());
      line = "";
    }
    for (const letter of word) {
      if (line !== "" && measure((line + letter).trimEnd()) > width) {
        lines.push(line);
        line = "";
      }
      line += letter;
    }
  }
  if (line.trimEnd() !== "") lines.push(line.trimEnd());
  return lines;
}

/// Draws a label of the page at a place, in CSS pixels.
export function drawLabel(context: CanvasRenderingContext2D, label: HTMLElement, at: { x: number; y: number }): void {
  const style = getComputedStyle(label);
  const pixels = (name: string): number => parseFloat(style.getPropertyValue(name));
  const textOf = (name: "b" | "span"): string => label.querySelector(name)?.textContent ?? "";
  const number = textOf("b");
  const size = pixels("font-size");
  const lineHeight = pixels("line-height") || 1.3 * size;
  const font = `${style.fontSize} ${style.fontFamily}`;
  context.save();
  context.font = `bold ${font}`;
  const numberWidth = Math.max(size, context.measureText(number).width);
  const [before, after, above] = [pixels("padding-left"), pixels("padding-right"), pixels("padding-top")];
  const beside = before + numberWidth + pixels("column-gap");
  context.font = font;
  const measure = (part: string): number => context.measureText(part).width;
  const widest = pixels("max-width");
  const lines = linesOf(textOf("span"), widest - beside - after, measure);
  const needed = (lines[0] === undefined ? before + numberWidth : beside + measure(lines[0])) + after;
  const width = lines.length > 1 ? widest : needed; // as browsers do it
  const height = Math.max(1, lines.length) * lineHeight + 2 * above;
  const [left, top] = [at.x + pixels("margin-left"), at.y + pixels("margin-top")];
  context.globalAlpha = pixels("opacity");
  context.beginPath();
  context.roundRect(left, top, width, height, pixels("border-top-left-radius"));
  context.fillStyle = style.backgroundColor;
  context.fill();
  context.strokeStyle = style.borderTopColor;
  context.stroke();
  context.textBaseline = "middle";
  const middleOf = (line: number): number => top + above + (line + 0.5) * lineHeight;
  context.fillStyle = style.color;
  lines.forEach((line, i) => context.fillText(line, left + beside, middleOf(i)));
  context.font = `bold ${font}`;
  context.textAlign = "center";
  context.fillStyle = getComputedStyle(label.querySelector("b") ?? label).color;
  context.fillText(number, left + before + numberWidth / 2, middleOf(0));
  context.restore();
}
