// SPDX-License-Identifier: Apache-2.0
// Draws the edges of a mesh over the picture, without those that its triangles hide. Each pixel of a triangle knows how far it is from
// the edges: Bærentzen, Nielsen, Gjøl, Larsen, Christensen, "Single-pass Wireframe Rendering", SIGGRAPH sketches 2006. That makes smooth
// lines of even width, which no offset of depths has to keep apart from the triangles.

import * as THREE from "three";
import type { TriangleMesh } from "../stream/triangle_mesh";
import { localSection } from "./section";
import type { Background, Style } from "./types";

const width = 1.1; // CSS pixels
const fineTriangle = 6; // CSS pixels; edges of triangles lower than that are fainter, so that they do not become an area
const faintest = 0.2;
const colour = (hex: number): THREE.Color => new THREE.Color(hex).convertLinearToSRGB();
const overDiscs = colour(0x0e1d33);
const overDots: Record<Background, THREE.Color> = { light: colour(0x1d5fa8), dark: colour(0x7db8f5) };

const vertexShader = /* glsl */ `
precision highp float;
uniform mat4 modelViewMatrix, projectionMatrix;
in vec3 position;
out vec3 weights;  // of the triangle's corners
out vec3 place;
void main() {
  place = position;
  int corner = gl_VertexID % 3;
  weights = vec3(corner == 0, corner == 1, corner == 2);
  gl_Position = projectionMatrix * (modelViewMatrix * vec4(position, 1.0));
}
`;

const fragmentShader = /* glsl */ `
precision highp float;
uniform vec3 colour;
uniform float width, fineTriangle, faintest;  // pixels
uniform vec4 section;  // as of the points
in vec3 weights;
in vec3 place;
layout(location = 0) out vec4 pixel;
void main() {
  if (dot(place, section.xyz) > section.w) discard;
  vec3 x = dFdx(weights), y = dFdy(weights);
  vec3 heights = inversesqrt(max(x * x + y * y, 1e-12));  // of the triangle over each edge, pixels
  vec3 away = weights * heights;
  float nearest = min(away.x, min(away.y, away.z));
  float lowest = min(heights.x, min(heights.y, heights.z));
  float cover = clamp(0.5 * width - nearest + 0.5, 0.0, 1.0);
  pixel = vec4(colour, cover * clamp(lowest / fineTriangle, faintest, 1.0));
}
`;

/// Keeps a mesh on the graphics card, and draws its edges.
export class Wireframe {
  private readonly geometry = new THREE.BufferGeometry();
  private readonly uniforms = {
    colour: { value: overDiscs },
    width: { value: width },
    fineTriangle: { value: fineTriangle },
    faintest: { value: faintest },
    section: { value: new THREE.Vector4(0, 0, 0, 1) },
  };
  private readonly material = new THREE.RawShaderMaterial({
    vertexShader,
    fragmentShader,
    uniforms: this.uniforms,
    glslVersion: THREE.GLSL3,
    side: THREE.DoubleSide,
    transparent: true,
  });
  private readonly mesh = new THREE.Mesh(this.geometry, this.material);

  constructor() {
    this.mesh.frustumCulled = false;
    this.set(null);
  }

  /// Replaces the mesh; null: there is none.
  set(mesh: TriangleMesh | null): void {
    this.geometry.dispose();
    this.geometry.setAttribute("position", new THREE.BufferAttribute(mesh === null ? new Float32Array(0) : cornersOf(mesh), 3));
    this.mesh.position.fromArray(mesh?.vertices.origin ?? [0, 0, 0]);
    this.mesh.visible = mesh !== null;
  }

  /// Draws the edges into `renderer`'s viewport, over what is there. Replaces the depths there by those of the mesh.
  render(renderer: THREE.WebGLRenderer, camera: THREE.Camera, style: Style, pixelRatio: number): void {
    if (!this.mesh.visible) return;
    const { material, uniforms } = this;
    uniforms.colour.value = style.mode === "dots" ? overDots[style.background] : overDiscs;
    uniforms.section.value.set(...localSection(style.section, this.mesh.position.toArray()));
    uniforms.width.value = width * pixelRatio;
    uniforms.fineTriangle.value = fineTriangle * pixelRatio;
    renderer.clearDepth();
    material.colorWrite = false;
    material.depthWrite = true;
    material.depthFunc = THREE.LessDepth;
    renderer.render(this.mesh, camera);
    // The same program gives the same depths.
    material.colorWrite = true;
    material.depthWrite = false;
    material.depthFunc = THREE.EqualDepth;
    renderer.render(this.mesh, camera);
  }

  dispose(): void {
    this.geometry.dispose();
    this.material.dispose();
  }
}

/// Lists the corners of all triangles: x, y, z of each.
function cornersOf({ vertices, triangles }: TriangleMesh): Float32Array<ArrayBuffer> {
  const { positions } = vertices;
  const corners = new Float32Array(3 * triangles.length);
  let at = 0;
  for (const vertex of triangles) {
    corners[at++] = positions[4 * vertex]!;
    corners[at++] = positions[4 * vertex + 1]!;
    corners[at++] = positions[4 * vertex + 2]!;
  }
  return corners;
}
