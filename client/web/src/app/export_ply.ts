// The points of a store as a binary PLY file.

import type { StreamedPoints } from "../stream";

/// Little-endian: x y z nx ny nz radius, and red green blue where there are colours. In the mesh's own frame,
/// in the order of the curve.
export function plyOf(store: StreamedPoints): Blob {
  const { places, normals, colours, origin } = store;
  const properties =
    ["x", "y", "z", "nx", "ny", "nz", "radius"].map((name) => `property float ${name}\n`).join("") +
    (colours === null ? "" : ["red", "green", "blue"].map((name) => `property uchar ${name}\n`).join(""));
  const format = "ply\nformat binary_little_endian 1.0\ncomment Curvecast\n";
  const header = `${format}element vertex ${store.count}\n${properties}end_header\n`;
  const stride = 28 + (colours === null ? 0 : 3);
  const view = new DataView(new ArrayBuffer(store.count * stride));
  let at = 0;
  for (const slot of store.order()) {
    for (let axis = 0; axis < 3; ++axis) {
      view.setFloat32(at + 4 * axis, places[4 * slot + axis]! + origin[axis]!, true);
      view.setFloat32(at + 12 + 4 * axis, normals[4 * slot + axis]! / 127, true);
    }
    view.setFloat32(at + 24, places[4 * slot + 3]!, true);
    for (let channel = 0; colours !== null && channel < 3; ++channel)
      view.setUint8(at + 28 + channel, colours[4 * slot + channel]!);
    at += stride;
  }
  return new Blob([header, view], { type: "application/octet-stream" });
}

/// Offers a file to the user.
export function download(blob: Blob, name: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
