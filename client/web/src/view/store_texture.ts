// SPDX-License-Identifier: Apache-2.0
// A column of a PointStore as a texture, which vertex shaders read by slot. An instance for each point would be simpler, but some drivers
// take the time of a draw call for each instance.

import * as THREE from "three";

/// Slots in a row, as in the shaders; a power of two.
export const rowSlots = 2048;

export type ColumnArray = Float32Array | Int8Array | Uint8Array | Uint32Array;

interface Layout {
  size: number; // values to a slot
  format: THREE.PixelFormat;
  type: THREE.TextureDataType;
  internal: THREE.PixelFormatGPU;
}

/// The layouts of the columns.
const layouts = {
  positions: { size: 4, format: THREE.RGBAFormat, type: THREE.FloatType, internal: "RGBA32F" },
  normals: { size: 4, format: THREE.RGBAFormat, type: THREE.ByteType, internal: "RGBA8_SNORM" },
  colours: { size: 4, format: THREE.RGBAFormat, type: THREE.UnsignedByteType, internal: "RGBA8" },
  painted: { size: 4, format: THREE.RGBAFormat, type: THREE.UnsignedByteType, internal: "RGBA8" },
  curvatures: { size: 2, format: THREE.RGFormat, type: THREE.FloatType, internal: "RG32F" },
  bends: { size: 4, format: THREE.RGBAFormat, type: THREE.UnsignedByteType, internal: "RGBA8" },
  ends: { size: 4, format: THREE.RGBAFormat, type: THREE.FloatType, internal: "RGBA32F" }, // two texels a slot
  ranks: { size: 1, format: THREE.RedIntegerFormat, type: THREE.UnsignedIntType, internal: "R32UI" },
} satisfies Record<string, Layout>;

export type ColumnName = keyof typeof layouts;

/// Keeps one column on the graphics card.
export class StoreTexture {
  private readonly layout: Layout;
  private textureNow: THREE.DataTexture | null = null;
  private rows = 0;
  /// The array and the texture of the last upload. Where either has changed, all slots are uploaded again.
  private array: ColumnArray | null = null;
  private handle: WebGLTexture | null = null;

  constructor(name: ColumnName) {
    this.layout = layouts[name];
  }

  get texture(): THREE.Texture | null {
    return this.textureNow;
  }

  /// Whether the graphics card has nothing of an array: the array is new, or the context was lost.
  lacks(renderer: THREE.WebGLRenderer, array: ColumnArray): boolean {
    const handle = this.textureNow && this.handleOf(renderer, this.textureNow);
    return array !== this.array || handle === null || handle !== this.handle;
  }

  /// Uploads slots of an array: [begin, end) pairs.
  upload(renderer: THREE.WebGLRenderer, array: ColumnArray, ranges: readonly number[]): void {
    const texture = this.textureFor(array.length / this.layout.size);
    renderer.initTexture(texture);
    const gl = renderer.getContext() as WebGL2RenderingContext;
    this.array = array;
    this.handle = this.handleOf(renderer, texture);
    if (!this.handle) return;
    renderer.state.bindTexture(gl.TEXTURE_2D, this.handle);
    gl.pixelStorei(gl.UNPACK_FLIP_Y_WEBGL, false);
    gl.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, false);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 4);
    const [format, type] = glNames(gl, this.layout);
    const put = (begin: number, width: number, height: number): void => {
      const [x, y] = [begin % rowSlots, Math.floor(begin / rowSlots)];
      gl.texSubImage2D(gl.TEXTURE_2D, 0, x, y, width, height, format, type, array, begin * this.layout.size);
    };
    for (let i = 0; i < ranges.length; i += 2) putRows(ranges[i]!, ranges[i + 1]!, put);
    renderer.state.unbindTexture();
  }

  dispose(): void {
    this.textureNow?.dispose();
    this.textureNow = null;
    this.array = this.handle = null;
  }

  private textureFor(slots: number): THREE.DataTexture {
    const rows = Math.max(1, Math.ceil(slots / rowSlots));
    if (this.textureNow && this.rows === rows) return this.textureNow;
    this.dispose();
    const { format, type, internal } = this.layout;
    const texture = new THREE.DataTexture(null, rowSlots, rows, format, type);
    texture.internalFormat = internal;
    // three.js reserves memory only: upload() fills it from the store's own arrays.
    texture.source.dataReady = false;
    texture.needsUpdate = true;
    this.rows = rows;
    return (this.textureNow = texture);
  }

  private handleOf(renderer: THREE.WebGLRenderer, texture: THREE.Texture): WebGLTexture | null {
    return (renderer.properties.get(texture) as { __webglTexture?: WebGLTexture }).__webglTexture ?? null;
  }
}

function glNames(gl: WebGL2RenderingContext, layout: Layout): [number, number] {
  const formats = new Map<number, number>([
    [THREE.RGBAFormat, gl.RGBA],
    [THREE.RGFormat, gl.RG],
    [THREE.RedIntegerFormat, gl.RED_INTEGER],
  ]);
  const types = new Map<number, number>([
    [THREE.FloatType, gl.FLOAT],
    [THREE.ByteType, gl.BYTE],
    [THREE.UnsignedByteType, gl.UNSIGNED_BYTE],
    [THREE.UnsignedIntType, gl.UNSIGNED_INT],
  ]);
  return [formats.get(layout.format) ?? gl.RGBA, types.get(layout.type) ?? gl.FLOAT];
}

/// Covers slots [begin, end) by rectangles: the rest of a row, whole rows, the beginning of a row.
export function putRows(begin: number, end: number, put: (begin: number, width: number, height: number) => void): void {
  while (begin < end) {
    const left = rowSlots - (begin % rowSlots);
    if (left < rowSlots || end - begin < rowSlots) {
      const width = Math.min(left, end - begin);
      put(begin, width, 1);
      begin += width;
    } else {
      const rows = Math.floor((end - begin) / rowSlots);
      put(begin, rowSlots, rows);
      begin += rows * rowSlots;
    }
  }
}
