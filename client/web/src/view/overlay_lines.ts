// SPDX-License-Identifier: Apache-2.0
// Draws lines and dots over the picture: of even width in pixels, smooth, and pale where the surface hides them.

import * as THREE from "three";
import type { Rectangle } from "./picture";
import type { AimedCamera } from "./three_camera";
import type { Vec } from "./types";

/// A line, or a dot where both ends are one.
export interface OverlayLine {
  from: Vec;
  to: Vec;
  /// CSS pixels.
  width: number;
  colour: THREE.Color;
}

const vertexShader = /* glsl */ `
precision highp float;
uniform mat4 modelViewMatrix, projectionMatrix;
uniform vec2 pixels;
uniform float pixelRatio, near;
uniform bool isParallel;
in vec3 position;
in vec3 from, to;
in vec4 colourWidth;
out vec2 pixelPosition;
flat out vec2 start, end;
flat out vec4 look;
out float inDepth;  // linear in the picture: the depth where rays are parallel, otherwise its inverse

vec2 toPixels(vec3 eye) {
  vec4 clip = projectionMatrix * vec4(eye, 1.0);
  return (0.5 + 0.5 * clip.xy / clip.w) * pixels;
}

void main() {
  vec3 a = (modelViewMatrix * vec4(from, 1.0)).xyz;
  vec3 b = (modelViewMatrix * vec4(to, 1.0)).xyz;
  float limit = -1.001 * near;
  if (!isParallel && a.z > limit && b.z > limit) {
    gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
    return;
  }
  if (!isParallel && a.z > limit) a = mix(a, b, (limit - a.z) / (b.z - a.z));
  if (!isParallel && b.z > limit) b = mix(b, a, (limit - b.z) / (a.z - b.z));
  start = toPixels(a);
  end = toPixels(b);
  look = vec4(colourWidth.rgb, colourWidth.w * pixelRatio);
  vec2 along = end - start;
  float size = length(along);
  along = size > 1e-3 ? along / size : vec2(1.0, 0.0);
  float reach = 0.5 * look.w + 1.0;
  pixelPosition = mix(start, end, step(0.0, position.x)) + reach * (position.x * along + position.y * vec2(-along.y, along.x));
  float depth = position.x < 0.0 ? -a.z : -b.z;
  inDepth = isParallel ? depth : 1.0 / depth;
  gl_Position = vec4(pixelPosition / pixels * 2.0 - 1.0, 0.0, 1.0);
}
`;

const fragmentShader = /* glsl */ `
precision highp float;
uniform highp sampler2D depths;
uniform bool hasDepths, isParallel;
uniform vec2 clip;
uniform float tolerance;  // units
in vec2 pixelPosition;
flat in vec2 start, end;
flat in vec4 look;
in float inDepth;
layout(location = 0) out vec4 pixel;
void main() {
  vec2 along = end - start;
  float t = clamp(dot(pixelPosition - start, along) / max(dot(along, along), 1e-6), 0.0, 1.0);
  float away = distance(pixelPosition, start + t * along);
  float cover = clamp(0.5 * look.w - away + 0.5, 0.0, 1.0);
  if (hasDepths) {
    ivec2 at = clamp(ivec2(pixelPosition), ivec2(0), textureSize(depths, 0) - 1);
    float depth = texelFetch(depths, at, 0).x;
    float surface = isParallel ? mix(clip.x, clip.y, depth) : clip.x * clip.y / (clip.y - depth * (clip.y - clip.x));
    if ((isParallel ? inDepth : 1.0 / inDepth) > surface + tolerance) cover *= 0.4;
  }
  pixel = vec4(look.rgb, cover);
}
`;

/// Keeps lines on the graphics card, and draws them.
export class OverlayLines {
  private readonly geometry = new THREE.InstancedBufferGeometry();
  private readonly uniforms = {
    pixels: { value: new THREE.Vector2() },
    pixelRatio: { value: 1 },
    near: { value: 0 },
    isParallel: { value: false },
    depths: { value: null as THREE.Texture | null },
    hasDepths: { value: false },
    clip: { value: new THREE.Vector2() },
    tolerance: { value: 0 },
  };
  private readonly material = new THREE.RawShaderMaterial({
    vertexShader,
    fragmentShader,
    uniforms: this.uniforms,
    glslVersion: THREE.GLSL3,
    transparent: true,
    depthTest: false,
    depthWrite: false,
    side: THREE.DoubleSide,
  });
  private readonly mesh = new THREE.Mesh(this.geometry, this.material);

  constructor() {
    this.mesh.frustumCulled = false;
    this.set([]);
  }

  /// Replaces all lines.
  set(lines: readonly OverlayLine[]): void {
    const { geometry } = this;
    // Ends are kept relative to the first one: single precision serves coordinates far from 0.
    const origin = lines[0]?.from ?? [0, 0, 0];
    this.mesh.position.fromArray(origin);
    const column = (size: number, of: (line: OverlayLine) => number[]): THREE.InstancedBufferAttribute =>
      new THREE.InstancedBufferAttribute(new Float32Array(lines.flatMap(of)), size);
    geometry.dispose();
    geometry.setIndex([0, 1, 2, 2, 1, 3]);
    geometry.setAttribute("position", new THREE.Float32BufferAttribute([-1, -1, 0, 1, -1, 0, -1, 1, 0, 1, 1, 0], 3));
    geometry.setAttribute(
      "from",
      column(3, ({ from }) => from.map((c, k) => c - origin[k]!)),
    );
    geometry.setAttribute(
      "to",
      column(3, ({ to }) => to.map((c, k) => c - origin[k]!)),
    );
    geometry.setAttribute(
      "colourWidth",
      column(4, ({ colour, width }) => [...colour.clone().convertLinearToSRGB().toArray(), width]),
    );
    geometry.instanceCount = lines.length;
  }

  /// Draws the lines into `renderer`'s viewport. `depths`: those of the surface; null: the surface hides nothing.
  render(
    renderer: THREE.WebGLRenderer,
    camera: AimedCamera,
    where: Rectangle,
    pixelRatio: number,
    depths: THREE.Texture | null,
    tolerance: number,
  ): void {
    if (this.geometry.instanceCount === 0) return;
    const { uniforms } = this;
    uniforms.pixels.value.set(where.width, where.height);
    uniforms.pixelRatio.value = pixelRatio;
    uniforms.near.value = camera.near;
    uniforms.isParallel.value = camera.isParallel;
    uniforms.clip.value.set(camera.near, camera.far);
    uniforms.depths.value = depths;
    uniforms.hasDepths.value = depths !== null;
    uniforms.tolerance.value = tolerance;
    renderer.render(this.mesh, camera);
  }

  dispose(): void {
    this.geometry.dispose();
    this.material.dispose();
  }
}
