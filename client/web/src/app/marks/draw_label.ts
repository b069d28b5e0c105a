// Labels of annotations in saved pictures and films, as the page's style has them.

const maxWidth = 256; // CSS pixels of a label, as in the style sheet
const padding = { left: 4, right: 7, vertical: 1 };
const gap = 6; // between number and text
const away = 7; // from the place that is meant
const radius = 9;
const faint = 0.45; // of what the surface hides

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

/// Draws a label at a place, in CSS pixels. `shown`: the one on the page, whose style it has.
export function drawLabel(
  context: CanvasRenderingContext2D,
  shown: HTMLElement,
  { number, text, isHidden }: { number: string; text: string; isHidden: boolean },
  at: { x: number; y: number },
): void {
  const style = getComputedStyle(shown);
  const size = parseFloat(style.fontSize);
  const lineHeight = parseFloat(style.lineHeight) || 1.3 * size;
  const font = `${style.fontSize} ${style.fontFamily}`;
  context.save();
  context.font = `bold ${font}`;
  const numberWidth = Math.max(size, context.measureText(number).width);
  const beside = padding.left + numberWidth + gap;
  context.font = font;
  const measure = (part: string): number => context.measureText(part).width;
  const lines = linesOf(text, maxWidth - beside - padding.right, measure);
  const width =
    lines.length === 0 ? padding.left + numberWidth + padding.right : beside + Math.max(...lines.map(measure)) + padding.right;
  const height = Math.max(1, lines.length) * lineHeight + 2 * padding.vertical;
  const [left, top] = [at.x + away, at.y + away];
  context.globalAlpha = isHidden ? faint : 1;
  context.beginPath();
  context.roundRect(left, top, width, height, radius);
  context.fillStyle = style.backgroundColor;
  context.fill();
  context.strokeStyle = style.borderTopColor;
  context.stroke();
  context.textBaseline = "middle";
  const middleOf = (line: number): number => top + padding.vertical + (line + 0.5) * lineHeight;
  context.fillStyle = style.color;
  lines.forEach((line, i) => context.fillText(line, left + beside, middleOf(i)));
  context.font = `bold ${font}`;
  context.textAlign = "center";
  context.fillStyle = getComputedStyle(shown.querySelector("b") ?? shown).color;
  context.fillText(number, left + padding.left + numberWidth / 2, middleOf(0));
  context.restore();
}
