// SPDX-License-Identifier: Apache-2.0
// GLSL of the passes that draw each point. `COLOURING` is the kind of a ColourScale.

import { cutFragment, cutVertex, discFunctions, pointFunctions } from "./disc_shaders";

/// Computes the colour of a point as squares of sRGB, which is nearly linear light.
const splatColour = /* glsl */ `
#if COLOURING == 3
uniform highp usampler2D column;
#elif COLOURING == 1 || COLOURING == 2
uniform highp sampler2D column;
#endif
#if COLOURING >= 2 && COLOURING <= 4
uniform sampler2D map;
uniform float mapScale, mapOffset;
#endif

vec3 splatColour(int slot) {
#if COLOURING == 1
  vec3 c = texelFetch(column, texelOf(slot), 0).rgb;
  return c * c;
#elif COLOURING == 5
  vec3 c = 0.5 + 0.5 * axis;
  return c * c;
#elif COLOURING >= 2
#if COLOURING == 2
  vec2 curvatures = texelFetch(column, texelOf(slot), 0).xy;
  float v = 0.5 * (curvatures.x + curvatures.y) / mapScale;
  float t = 0.5 + 0.5 * v / (0.7 + abs(v));
#elif COLOURING == 3
  float t = float(texelFetch(column, texelOf(slot), 0).x) / mapScale;
#else
  float t = (-2.0 * log2(point.w) - mapOffset) / mapScale;
#endif
  vec3 c = texture(map, vec2(t, 0.5)).rgb;
  return c * c;
#else
  return vec3(1.0);
#endif
}
`;

/// The declarations that three.js adds to shaders that are not raw.
const declarations = /* glsl */ `
precision highp float;
precision highp int;
uniform mat4 modelViewMatrix, projectionMatrix;
`;

/// Draws depths alone, by squares about as large as the discs: few pixels are discarded.
export const depthVertexShader = /* glsl */ `
${declarations}
${discFunctions}
${cutVertex}
void main() {
  gl_Position = placeCorner() ? projectionMatrix * vec4(corner, 1.0) : vec4(0.0, 0.0, 2.0, 1.0);
  CUT
}
`;

export const depthFragmentShader = /* glsl */ `
precision mediump float;
${cutFragment}
layout(location = 0) out vec4 unused;
#ifdef HAS_COLOURS
layout(location = 1) out vec4 unusedToo;
#endif
void main() {
  CUT
  unused = vec4(0.0);
#ifdef HAS_COLOURS
  unusedToo = vec4(0.0);
#endif
}
`;

/// Sums normals and colours over the discs near the visible surface.
export const blendVertexShader = /* glsl */ `
${declarations}
${discFunctions}
#ifdef HAS_COLOURS
${splatColour}
flat out vec3 colour;
#endif
${cutVertex}
out vec2 inDisc;
out float past;
flat out vec4 normalWeight;

void main() {
  bool isPoint = placeCorner();
  CUT
  if (!isPoint) {
    gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
    return;
  }
  gl_Position = projectionMatrix * vec4(corner, 1.0);
  inDisc = inShape;
  past = beyondOutline;
  // Back faces count only where nothing faces the eye: in the holes of an open surface, but not behind its rim.
  normalWeight = vec4(discNormal, mix(0.002, 1.0, smoothstep(-0.15, 0.15, facing)));
#ifdef HAS_COLOURS
  colour = splatColour(slot);
#endif
}
`;

export const blendFragmentShader = /* glsl */ `
precision highp float;
${cutFragment}
in vec2 inDisc;
in float past;
flat in vec4 normalWeight;
layout(location = 0) out vec4 normalSum;  // w: sum of the kernels of front and back faces
#ifdef HAS_COLOURS
flat in vec3 colour;
layout(location = 1) out vec4 colourSum;  // w: sum of the weights
#endif
void main() {
  CUT
#ifdef QUICK
  float kernel = 1.0;  // only the nearest disc counts
#else
  float t = max(1.0 - dot(inDisc, inDisc), 0.0);
  float kernel = t * t * t;  // like a Gaussian, and 0 at the edge
  kernel *= clamp(-past, 0.0, 1.0);  // 0 at the outline, too, so that its slope tells where that is
#endif
  float weight = normalWeight.w * kernel;
  normalSum = vec4(normalWeight.xyz * weight, kernel);
#ifdef HAS_COLOURS
  colourSum = vec4(colour, 1.0) * weight;
#endif
}
`;

/// Draws dots of one size before the surface. Each dot is drawn as a whole, or not at all.
export const dotVertexShader = /* glsl */ `
${declarations}
${pointFunctions}
uniform highp sampler2D depths;
uniform vec2 clip;       // near and far
uniform float tolerance;  // in radii
uniform float diameter;  // pixels
uniform float splatScale;
uniform vec3 plainColour;
${splatColour}
flat out vec3 colour;

float distanceOf(float depth, bool isParallel) {
  return isParallel ? mix(clip.x, clip.y, depth) : clip.x * clip.y / (clip.y - depth * (clip.y - clip.x));
}

void main() {
  int slot = gl_VertexID * stride;
  gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
  gl_PointSize = 1.0;
  if (!readPoint(slot)) return;
  vec3 center = (modelViewMatrix * vec4(point.xyz, 1.0)).xyz;
  bool isParallel = projectionMatrix[3][3] == 1.0;
  if (center.z >= 0.0 && !isParallel) return;
  vec4 where = projectionMatrix * vec4(center, 1.0);
  vec2 size = vec2(textureSize(depths, 0));
  ivec2 pixel = ivec2(clamp((0.5 + 0.5 * where.xy / where.w) * size, vec2(0.0), size - 1.0));
  float surface = distanceOf(texelFetch(depths, pixel, 0).x, isParallel);
  if (-center.z > surface + tolerance * point.w * splatScale) return;
  gl_Position = where;
  gl_PointSize = diameter + 1.0;
  vec3 n = mat3(modelViewMatrix) * axis;
  float facing = dot(n, isParallel ? vec3(0.0, 0.0, 1.0) : -normalize(center)) / max(length(n), 0.01);
#if COLOURING == 0
  colour = plainColour;
#else
  colour = sqrt(splatColour(slot));
#endif
#ifndef BOTH_SIDES
  if (facing < -0.1) colour = mix(colour, vec3(0.5), 0.4);
#endif
}
`;

export const dotFragmentShader = /* glsl */ `
precision highp float;
uniform float diameter;
flat in vec3 colour;
layout(location = 0) out vec4 pixel;
void main() {
  float distance = length(gl_PointCoord - 0.5) * (diameter + 1.0);
  float cover = clamp(0.5 * diameter - distance + 0.5, 0.0, 1.0);
  if (cover <= 0.0) discard;
  pixel = vec4(colour, cover);
}
`;

/// Draws opaque discs in one pass, with a light at the eye: for any scene, and where sums cannot be drawn.
export const solidVertexShader = /* glsl */ `
#define CONE 0.3
${discFunctions}
${splatColour}
uniform float dotDiameter;  // pixels; 0: discs
uniform vec2 pixels;        // of the picture
uniform vec3 plainColour;   // linear light
out vec2 inDisc;
flat out vec3 colour;

void main() {
  if (!placeCorner() || (dotDiameter > 0.0 && facing < -0.1)) {
    gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
    return;
  }
  gl_Position = projectionMatrix * vec4(corner, 1.0);
  if (dotDiameter > 0.0) {
    gl_Position = projectionMatrix * modelViewMatrix * vec4(point.xyz, 1.0);
    gl_Position.xy += inShape * 1.1547 * dotDiameter / pixels * gl_Position.w;
  }
  inDisc = inShape * 1.1547;
  float lit = abs(facing);
  vec3 albedo = COLOURING == 0 ? plainColour : splatColour(slot);
  if (facing < 0.0) albedo *= vec3(0.42, 0.46, 0.55);
  colour = albedo * (0.28 + 0.72 * lit) + 0.05 * pow(lit, 24.0);
}
`;

export const solidFragmentShader = /* glsl */ `
in vec2 inDisc;
flat in vec3 colour;
void main() {
  if (dot(inDisc, inDisc) > 1.0) discard;
  gl_FragColor = vec4(colour, 1.0);
  #include <tonemapping_fragment>
  #include <colorspace_fragment>
}
`;
