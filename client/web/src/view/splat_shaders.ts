// GLSL of the passes that draw each point. `COLOURING` is the kind of a ColourScale.

import { directions, largestBend } from "./discs/disc_bends";
import { slack } from "./discs/disc_ends";

/// Reads a point by its slot, in vertex shaders. The numbers are those of store_texture and points_geometry.
const pointFunctions = /* glsl */ `
uniform highp sampler2D positions;
uniform highp sampler2D normalsOf;
uniform int slots;
uniform int stride;    // from the slot of a shape to that of the next
uniform vec4 section;  // normal and offset of the plane that cuts the surface open

vec4 point;  // relative to the store's origin; w: radius
vec3 axis;   // the normal

ivec2 texelOf(int slot) { return ivec2(slot & 2047, slot >> 11); }

// Returns false for a slot without a point, or with one that is cut off.
bool readPoint(int slot) {
  if (slot >= slots) return false;
  point = texelFetch(positions, texelOf(slot), 0);
  axis = texelFetch(normalsOf, texelOf(slot), 0).xyz;
  return point.w > 0.0 && dot(point.xyz, section.xyz) <= section.w;
}
`;

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

/// The longest that a disc seen from its edge may be, in radii, over the square root of its cosine. Discs of points that are even on the
/// screen grow as they lean: with this bound they are all about as long.
export const slimness = 2.2;

/// Places a corner of a disc in its tangent plane: that of a square, or of a hexagon whose middle stands out by CONE radii.
const discFunctions = /* glsl */ `
${pointFunctions}
const float SLIMNESS = ${slimness.toFixed(2)};
const int DIRECTIONS = ${directions};
const float LARGEST_BEND = ${largestBend.toFixed(1)};
const float UNKNOWN_BEND = 0.1, NOBODYS_BEND = 0.5;  // the former as on a ball of ten radii
const float SLACK = ${slack.toFixed(2)};  // as in the planes of ends
uniform float splatScale;
uniform float backShift;  // along the ray, in radii
uniform float extent;     // of the shape, in radii
uniform float minRadius;  // at distance 1 from the eye, or anywhere where rays are parallel
#ifdef IS_FROZEN
uniform vec4 frozenEye;    // of the camera that the points are for, in eye coordinates; w: 0 where its rays are parallel
uniform float frozenSlim;  // as SLIMNESS
#endif

#ifdef CONE
const int kCorners = 7;
const vec2 kPlaces[7] = vec2[7](vec2(1.0, 0.0), vec2(0.5, 0.8660254), vec2(-0.5, 0.8660254), vec2(-1.0, 0.0),
                                vec2(-0.5, -0.8660254), vec2(0.5, -0.8660254), vec2(0.0));
#else
const int kCorners = 4;
const vec2 kPlaces[4] = vec2[4](vec2(-1.0, -1.0), vec2(1.0, -1.0), vec2(-1.0, 1.0), vec2(1.0, 1.0));
#endif

int slot;
vec2 inShape;     // the corner of the square around the unit circle, or of the hexagon in it
vec3 corner;      // in eye coordinates
#ifdef HAS_ENDS
uniform highp sampler2D ends;
out vec2 beyond;  // the planes at which the disc ends, where that is above 0
#endif
vec3 discNormal;  // in eye coordinates
float facing;

#ifdef HAS_BENDS
uniform highp sampler2D bends;  // see findDiscBends()

float rootOfBend(int direction) {
  int byte = int(255.0 * texelFetch(bends, texelOf(2 * slot + direction / 4), 0)[direction % 4] + 0.5);
  // Where nobody is, the surface ends, or has few points since nobody sees it. Of a face: here is the border of a sheet.
  if (byte == 255) return sqrt(NOBODYS_BEND * (1.0 - smoothstep(0.5, 0.7, abs(facing))) / LARGEST_BEND);
  return float(byte - 1) / 253.0;  // below 0: it is not known
}
#endif

// How far the surface bends away from the disc's plane on the way of the point's radius in a direction.
float bendTowards(vec3 direction) {
#ifdef HAS_BENDS
  if (rootOfBend(0) < 0.0) return UNKNOWN_BEND;
  vec3 n = normalize(axis);
  float turn = n.z >= 0.0 ? 1.0 : -1.0;
  float a = -1.0 / (turn + n.z);
  float b = n.x * n.y * a;
  vec3 first = vec3(1.0 + turn * n.x * n.x * a, turn * b, -turn * n.x);
  vec3 second = vec3(b, turn + n.y * n.y * a, -n.y);
  vec3 way = direction * mat3(modelViewMatrix);  // in the store's coordinates: views only turn
  float turned = float(DIRECTIONS) * fract(atan(dot(way, second), dot(way, first)) / 6.2831853);
  int before = int(turned) % DIRECTIONS;
  float root = mix(rootOfBend(before), rootOfBend((before + 1) % DIRECTIONS), fract(turned));
  return LARGEST_BEND * root * root;
#else
  return UNKNOWN_BEND;
#endif
}

// Returns false where there is nothing to draw.
bool placeCorner() {
  int shape = gl_VertexID / kCorners;
  slot = (gl_InstanceID * 1024 + shape) * stride;
  if (!readPoint(slot)) return false;
  int which = gl_VertexID - shape * kCorners;
  inShape = kPlaces[which];
  vec3 center = (modelViewMatrix * vec4(point.xyz, 1.0)).xyz;
  bool isParallel = projectionMatrix[3][3] == 1.0;
  if (center.z >= 0.0 && !isParallel) return false;
  vec3 view = isParallel ? vec3(0.0, 0.0, 1.0) : -normalize(center);
  discNormal = mat3(modelViewMatrix) * axis;
  discNormal = dot(discNormal, discNormal) > 0.01 ? normalize(discNormal) : view;
  facing = dot(discNormal, view);
  vec3 lean = discNormal - facing * view;  // where the disc leans, seen by the eye
  if (dot(lean, lean) < 1e-8) lean = cross(view, abs(view.x) < 0.7 ? vec3(1, 0, 0) : vec3(0, 1, 0));
  lean = normalize(lean);
  vec3 major = cross(view, lean);
  vec3 minor = cross(discNormal, major);
  float least = minRadius * (isParallel ? 1.0 : -center.z);
  float radius = max(point.w * splatScale * length(modelViewMatrix[0].xyz), least);
#ifdef IS_FROZEN
  radius = max(radius * min(1.0, frozenSlim * sqrt(abs(dot(discNormal, normalize(frozenEye.xyz - frozenEye.w * center))))), least);
#endif
  // A disc thinner than a pixel is turned a little to the eye, so that it is never lost between pixels.
  float lost = max(least - radius * abs(facing), 0.0);
  minor = radius * minor - (facing < 0.0 ? -lost : lost) * lean;
  // Discs seen from their edges would stick out of a rough surface as needles. On a smooth surface, shorter discs change only the last
  // pixels of the rim.
  float longest = min(1.0, SLIMNESS * sqrt(abs(facing)));
  major *= max(radius * longest, least);
  // Where the surface bends away from the eye, discs would stick out of it. It ends facing ^ 2 / 2 bend beyond a disc's middle, as the
  // eye sees it, and the disc halfway there, since the last ones blend: core/render/disc_outline.cpp.
  if (abs(facing) < 0.9999) {
    float bend = max(bendTowards(facing < 0.0 ? view : -view) * radius / point.w, 1e-6);
    float outline = 0.25 * facing * facing / bend * radius / (extent * max(radius * abs(facing), least));  // as inShape
    inShape.x = facing < 0.0 ? min(inShape.x, outline) : max(inShape.x, -outline);  // a front has less minor there, a back more
  }
  vec2 disc = extent * inShape;
  corner = center + disc.x * minor + disc.y * major;
#ifdef HAS_ENDS
  vec4 end1 = texelFetch(ends, texelOf(2 * slot), 0);
  vec4 end2 = texelFetch(ends, texelOf(2 * slot + 1), 0);
  vec3 away = (corner - center) * mat3(modelViewMatrix);  // back in the store's coordinates: views only turn
  beyond = vec2(dot(end1.xyz, away) - end1.w, dot(end2.xyz, away) - end2.w);
  // At an outline, backs would stick out by what discs overlap by.
  if (facing < 0.0) beyond += SLACK * point.w * splatScale;
#endif
#ifdef CONE
  if (which == 6) corner += CONE * radius * view;
#endif
  corner += backShift * radius * (isParallel ? -view : normalize(corner));
  return true;
}
`;

/// Cuts off the parts of discs that reach out of a frozen camera's picture, and over creases.
const cutVertex = /* glsl */ `
#ifdef IS_FROZEN
uniform mat4 frozenClip;  // eye coordinates to that camera's clip space
out vec4 inFrozen;
#define CUT inFrozen = frozenClip * vec4(corner, 1.0);
#else
#define CUT
#endif
`;
const cutFragment = /* glsl */ `
#ifdef IS_FROZEN
in highp vec4 inFrozen;
#define CUT_FROZEN if (any(greaterThan(abs(inFrozen.xy), inFrozen.ww))) discard;
#else
#define CUT_FROZEN
#endif
#ifdef HAS_ENDS
in highp vec2 beyond;
#define CUT CUT_FROZEN if (max(beyond.x, beyond.y) > 0.0) discard;
#else
#define CUT CUT_FROZEN
#endif
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
  if (facing < -0.1) colour = mix(colour, vec3(0.5), 0.4);
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
