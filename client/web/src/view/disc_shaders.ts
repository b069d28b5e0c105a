// SPDX-License-Identifier: Apache-2.0
// GLSL of how the disc of a point lies in the picture, and where it ends.

import { directions, largestBend } from "./discs/disc_bends";
import { slack } from "./discs/disc_ends";

/// Reads a point by its slot, in vertex shaders. The numbers are those of store_texture and points_geometry.
export const pointFunctions = /* glsl */ `
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

/// The longest that a disc seen from its edge may be, in radii, over the square root of its cosine. Discs of points that are even on the
/// screen grow as they lean: with this bound they are all about as long.
export const slimness = 2.2;

/// Of the squares that hide what is behind them, in radii: about as large as the discs.
export const hidingExtent = 0.8;

/// Places a corner of a disc in its tangent plane: that of a square, or of a hexagon whose middle stands out by CONE radii.
export const discFunctions = /* glsl */ `
${pointFunctions}
const float SLIMNESS = ${slimness.toFixed(2)};
const int DIRECTIONS = ${directions};
const float LARGEST_BEND = ${largestBend.toFixed(1)};
const float UNKNOWN_BEND = 0.1, NOBODYS_BEND = 0.5;  // the former as on a ball of ten radii
const float PIXEL = ${(hidingExtent * Math.SQRT2).toFixed(4)};  // of a picture, in the least radii that are drawn
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
float beyondOutline;  // pixels; 0 and less

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
#ifdef BOTH_SIDES
  if (facing < 0.0) {  // all that follows takes it for a front
    discNormal = -discNormal;
    facing = -facing;
  }
#endif
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
  beyondOutline = -1.0;
  if (abs(facing) < 0.9999) {
    float bend = max(bendTowards(facing < 0.0 ? view : -view) * radius / point.w, 1e-6);
    float inPicture = extent * max(radius * abs(facing), least);  // length of what is 1 in inShape
    float outline = 0.25 * facing * facing / bend * radius / inPicture;
    inShape.x = facing < 0.0 ? min(inShape.x, outline) : max(inShape.x, -outline);  // a front has less minor there, a back more
    beyondOutline = ((facing < 0.0 ? inShape.x : -inShape.x) - outline) * inPicture / (PIXEL * least);
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
export const cutVertex = /* glsl */ `
#ifdef IS_FROZEN
uniform mat4 frozenClip;  // eye coordinates to that camera's clip space
out vec4 inFrozen;
#define CUT inFrozen = frozenClip * vec4(corner, 1.0);
#else
#define CUT
#endif
`;
export const cutFragment = /* glsl */ `
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
