// Files of points for tests.

/// A file of texts and bytes.
export const fileOf = (...parts: (string | Uint8Array<ArrayBuffer>)[]): Blob => new Blob(parts);

/// A reader's file tells nobody how far it is.
export const unheard = (): void => {};

const sizes = { char: 1, uchar: 1, short: 2, ushort: 2, int: 4, uint: 4, float: 4, double: 8 };
export type Type = keyof typeof sizes;

/// Numbers of the given types, one after the other.
export function packed(values: readonly (readonly [Type, number])[], isLittle = true): Uint8Array<ArrayBuffer> {
  const view = new DataView(new ArrayBuffer(values.reduce((sum, [type]) => sum + sizes[type], 0)));
  let at = 0;
  for (const [type, value] of values) {
    if (type === "char") view.setInt8(at, value);
    else if (type === "uchar") view.setUint8(at, value);
    else if (type === "short") view.setInt16(at, value, isLittle);
    else if (type === "ushort") view.setUint16(at, value, isLittle);
    else if (type === "int") view.setInt32(at, value, isLittle);
    else if (type === "uint") view.setUint32(at, value, isLittle);
    else if (type === "float") view.setFloat32(at, value, isLittle);
    else view.setFloat64(at, value, isLittle);
    at += sizes[type];
  }
  return new Uint8Array(view.buffer);
}

interface Las {
  minor?: number;
  format?: number;
  recordBytes?: number;
  pointsAt?: number;
  count?: number;
  records: readonly { place: readonly number[]; intensity?: number; colour?: readonly number[] }[];
}

const colourAt = [0, 0, 20, 28, 0, 28, 0, 30, 30, 0, 30];
const recordSizes = [20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67];

/// A LAS file with the scale 0.01 and the offset 1000, 2000, 3000, whose records have integers for their places.
export function lasOf({ minor = 2, format = 2, recordBytes = recordSizes[format] ?? 20, pointsAt, count, records }: Las): Blob {
  const header = minor >= 4 ? 375 : 227;
  const bytes = new Uint8Array(header + recordBytes * records.length);
  const view = new DataView(bytes.buffer);
  bytes.set(new TextEncoder().encode("LASF"));
  view.setUint8(24, 1);
  view.setUint8(25, minor);
  view.setUint16(94, header, true);
  view.setUint32(96, pointsAt ?? header, true);
  view.setUint8(104, format);
  view.setUint16(105, recordBytes, true);
  if (minor >= 4) view.setBigUint64(247, BigInt(count ?? records.length), true);
  else view.setUint32(107, count ?? records.length, true);
  for (let axis = 0; axis < 3; ++axis) {
    view.setFloat64(131 + 8 * axis, 0.01, true);
    view.setFloat64(155 + 8 * axis, 1000 * (1 + axis), true);
  }
  records.forEach(({ place, intensity = 0, colour = [] }, i) => {
    const at = header + recordBytes * i;
    place.forEach((value, axis) => view.setInt32(at + 4 * axis, value, true));
    view.setUint16(at + 12, intensity, true);
    const begin = colourAt[format] ?? 0;
    if (begin > 0) colour.forEach((value, channel) => view.setUint16(at + begin + 2 * channel, value, true));
  });
  return new Blob([bytes]);
}
