// Point clouds of a sphere, as the files that scanners and their programs write.

/// Evenly spread points of a sphere, by the golden angle, as [x, y, z] about `centre`.
export function spherePoints(count, centre = [0, 0, 0], radius = 1) {
  return Array.from({ length: count }, (_, i) => {
    const z = 1 - (2 * i + 1) / count;
    const [r, angle] = [Math.sqrt(1 - z * z), 2.399963 * i];
    return [r * Math.cos(angle), r * Math.sin(angle), z].map((value, axis) => centre[axis] + radius * value);
  });
}

/// A binary PLY file without faces, little endian: places as floats, and a colour for each, [red, green, blue].
export function plyCloud(points, colourOf) {
  const header =
    `ply\nformat binary_little_endian 1.0\nelement vertex ${points.length}\n` +
    "property float x\nproperty float y\nproperty float z\n" +
    "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
  const rows = Buffer.alloc(15 * points.length);
  points.forEach((point, i) => {
    point.forEach((value, axis) => rows.writeFloatLE(value, 15 * i + 4 * axis));
    colourOf(point).forEach((value, channel) => rows.writeUInt8(value, 15 * i + 12 + channel));
  });
  return Buffer.concat([Buffer.from(header), rows]);
}

/// Lines of x, y and z.
export const xyzCloud = (points) => Buffer.from(points.map((point) => `${point.join(" ")}\n`).join(""));

/// LAS 1.2 with points of format 2: places in millimetres from `offset`, and colours of 16 bits.
export function lasCloud(points, offset, colourOf) {
  const bytes = Buffer.alloc(227 + 26 * points.length);
  bytes.write("LASF", 0, "latin1");
  bytes.set([1, 2], 24);
  bytes.writeUInt16LE(227, 94);
  bytes.writeUInt32LE(227, 96);
  bytes.writeUInt8(2, 104);
  bytes.writeUInt16LE(26, 105);
  bytes.writeUInt32LE(points.length, 107);
  for (let axis = 0; axis < 3; ++axis) {
    bytes.writeDoubleLE(0.001, 131 + 8 * axis);
    bytes.writeDoubleLE(offset[axis], 155 + 8 * axis);
  }
  points.forEach((point, i) => {
    const at = 227 + 26 * i;
    point.forEach((value, axis) => bytes.writeInt32LE(Math.round((value - offset[axis]) / 0.001), at + 4 * axis));
    colourOf(point).forEach((value, channel) => bytes.writeUInt16LE(257 * value, at + 20 + 2 * channel));
  });
  return bytes;
}
