// SPDX-License-Identifier: Apache-2.0
// Colour maps that are even to the eye: control colours, joined in Oklab (Ottosson, "A perceptual color space for image
// processing", 2020).

/// Number of colours of a map.
export const mapSize = 256;

export type MapName = "diverging" | "sequential" | "warm";

const controls: Record<MapName, readonly string[]> = {
  // For curvature: hollows blue, the flat nearly white, ridges red.
  diverging: ["#1b3a7a", "#2f6db3", "#7fb0d6", "#f1eee8", "#e2a27c", "#c4512f", "#7a1626"],
  // For ranks: from the first points, dark, to the last.
  sequential: ["#2a1a5e", "#2b4a8f", "#1f7a96", "#35a07e", "#93c452", "#f4dc4a"],
  // For densities: from sparse, dark, to dense.
  warm: ["#231942", "#5a2a77", "#a0336f", "#de5a52", "#f69a48", "#fbe491"],
};

type Triple = [number, number, number];

const linear = (c: number): number => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
const encoded = (c: number): number => (c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055);

function fromHex(hex: string): Triple {
  const [r, g, b] = [1, 3, 5].map((at) => linear(parseInt(hex.slice(at, at + 2), 16) / 255)) as Triple;
  const l = Math.cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
  const m = Math.cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
  const s = Math.cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
  return [
    0.2104542553 * l + 0.793617785 * m - 0.0040720468 * s,
    1.9779984951 * l - 2.428592205 * m + 0.4505937099 * s,
    0.0259040371 * l + 0.7827717662 * m - 0.808675766 * s,
  ];
}

function toBytes([lightness, a, b]: Triple): Triple {
  const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (lightness - 0.0894841775 * a - 1.291485548 * b) ** 3;
  const rgb: Triple = [
    4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
    -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
    -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s,
  ];
  return rgb.map((c) => Math.round(255 * encoded(Math.min(1, Math.max(0, c))))) as Triple;
}

/// Makes a map: mapSize colours of 4 bytes, red, green, blue (sRGB), 255.
export function makeColourMap(name: MapName): Uint8Array {
  const points = controls[name].map(fromHex);
  const map = new Uint8Array(4 * mapSize);
  for (let i = 0; i < mapSize; ++i) {
    const at = (i / (mapSize - 1)) * (points.length - 1);
    const k = Math.min(Math.floor(at), points.length - 2);
    const mixed = points[k]!.map((c, j) => c + (at - k) * (points[k + 1]![j]! - c)) as Triple;
    map.set([...toBytes(mixed), 255], 4 * i);
  }
  return map;
}
