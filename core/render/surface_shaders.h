// The GLSL of the passes that every picture of a surface ends with. Internal to core/render.
//
// Pictures are drawn upside down for GL, so that the first row read back is the top one.
#pragma once

namespace curvecast {

inline constexpr char kScreenVertexShader[] = R"(#version 330 core
void main() {
  gl_Position = vec4((gl_VertexID & 1) * 4 - 1, (gl_VertexID & 2) * 2 - 1, 0, 1);
}
)";

// What the two screen passes share: the visible surface at a sample.
inline constexpr char kSurfaceFunctions[] = R"(#version 330 core
uniform sampler2D normals;
uniform sampler2D depths;
uniform vec2 ray_scale, ray_offset;  // sample -> (x, y) at distance 1
uniform int supersample;
uniform bool has_normals;
uniform float mean_radius;
uniform float samples_per_unit;  // at distance 1
uniform float least_kernel;      // where the surface ends

// Eye coordinates; z = 0 where there is no surface.
vec3 position_at(ivec2 s) {
  if (texelFetch(normals, s, 0).w < least_kernel) return vec3(0.0);
  vec2 sum = texelFetch(depths, s, 0).xy;
  float depth = sum.x / sum.y;
  return vec3((vec2(s) * ray_scale + ray_offset) * depth, -depth);
}

// Over both sides where the surface goes on, else over the one that lies nearer in depth: not across an edge.
vec3 slope(vec3 before, vec3 here, vec3 after) {
  vec3 a = here - before, b = after - here;
  if (before.z == 0.0) return b;
  if (after.z == 0.0) return a;
  if (abs(a.z - b.z) < 4.0 * mean_radius) return a + b;
  return abs(a.z) < abs(b.z) ? a : b;
}

vec3 normal_at(ivec2 s, vec3 p) {
  vec3 n = texelFetch(normals, s, 0).xyz;
  if (!has_normals) {
    int d = clamp(int(mean_radius * samples_per_unit / -p.z), 1, 32);
    ivec2 last = textureSize(normals, 0) - 1;
    vec3 x = slope(position_at(max(s - ivec2(d, 0), ivec2(0))), p, position_at(min(s + ivec2(d, 0), last)));
    vec3 y = slope(position_at(max(s - ivec2(0, d), ivec2(0))), p, position_at(min(s + ivec2(0, d), last)));
    n = cross(y, x);
  }
  float size = length(n);
  vec3 view = -normalize(p);
  n = size > 1e-12 ? n / size : view;
  float facing = dot(n, view);
  if (facing >= 0.0) return n;
  // The back of an open surface is turned round. At a grazing angle it is the rim of discs that stick out behind the silhouette:
  // mirrored, so that shading goes on as before the silhouette.
  return normalize(mix(n - 2.0 * facing * view, -n, smoothstep(0.75, 0.95, -facing)));
}
)";

// One depth per pixel, 0 where there is no surface.
inline constexpr char kPixelDepthFragmentShader[] = R"(
layout(location = 0) out float pixel_depth;
void main() {
  float depth = 0.0;
  for (int i = supersample * supersample - 1; i >= 0; --i) {
    vec3 p = position_at(ivec2(gl_FragCoord.xy) * supersample + ivec2(i % supersample, i / supersample));
    if (p.z != 0.0) depth = -p.z;
  }
  pixel_depth = depth;
}
)";

// Alchemy ambient obscurance: McGuire, Osman, Bukowski, Hennessy, HPG 2011.
inline constexpr char kOcclusionFragmentShader[] = R"(
uniform sampler2D pixel_depths;
layout(location = 0) out float openness;
const int kTaps = 16;
const float kReach = 0.22;  // in half diagonals of the cloud

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy), last = textureSize(pixel_depths, 0) - 1;
  openness = 1.0;
  float depth = texelFetch(pixel_depths, pixel, 0).x;
  if (depth == 0.0) return;
  vec3 p = vec3((vec2(pixel * supersample) * ray_scale + ray_offset) * depth, -depth);
  vec3 n = normal_at(pixel * supersample, p);
  float pixels_per_unit = samples_per_unit / (float(supersample) * depth);
  float reach = clamp(kReach * pixels_per_unit, 4.0, 0.25 * float(last.y + 1));
  float reach_world = reach / pixels_per_unit;
  // Every pixel of a block of 4 x 4 turns the spiral by its own sixteenth; the next pass takes blocks together.
  float turn = float((pixel.x & 3) * 4 + (((pixel.y & 3) + 2 * (pixel.x & 3)) & 3)) * (6.2831853 / 16.0);
  float sum = 0.0;
  for (int i = 0; i < kTaps; ++i) {
    float t = (float(i) + 0.7) / float(kTaps);
    float angle = float(i) * 2.3999632 + turn;
    ivec2 tap = clamp(pixel + ivec2(reach * t * t * vec2(cos(angle), sin(angle))), ivec2(0), last);
    float d = texelFetch(pixel_depths, tap, 0).x;
    vec3 v = vec3((vec2(tap * supersample) * ray_scale + ray_offset) * d, -d) - p;
    float d2 = dot(v, v);
    float fade = d > 0.0 ? max(1.0 - d2 / (reach_world * reach_world), 0.0) : 0.0;
    sum += fade * max(dot(v, n) * inversesqrt(d2 + 1e-9) - 0.1, 0.0);
  }
  openness = clamp(1.0 - 1.9 * sum / float(kTaps), 0.0, 1.0);
}
)";

// Averages what lies at a like depth: the surface behind an edge has its own occlusion.
inline constexpr char kSmoothFragmentShader[] = R"(
uniform sampler2D pixel_depths;
uniform sampler2D occlusions;
layout(location = 0) out float openness;
void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy), last = textureSize(occlusions, 0) - 1;
  float depth = texelFetch(pixel_depths, pixel, 0).x;
  float reach = 0.02 + 8.0 * float(supersample) * depth / samples_per_unit;
  float sum = 0.0, weights = 0.0;
  for (int y = -2; y < 2; ++y) {
    for (int x = -2; x < 2; ++x) {
      ivec2 tap = clamp(pixel + ivec2(x, y), ivec2(0), last);
      float weight = max(1.0 - abs(texelFetch(pixel_depths, tap, 0).x - depth) / reach, 0.001);
      sum += weight * texelFetch(occlusions, tap, 0).x;
      weights += weight;
    }
  }
  openness = sum / weights;
}
)";

inline constexpr char kShadeFragmentShader[] = R"(
uniform sampler2D colors;
uniform sampler2D occlusions;
uniform bool has_colors, has_occlusion, is_matte;
uniform vec3 surface_color, background_top, background_bottom;  // linear light
uniform float height;
layout(location = 0) out vec4 pixel_color;

// Eye coordinates: the lights move with the camera.
const vec3 kKey = normalize(vec3(-0.55, 0.75, 0.70));
const vec3 kFill = normalize(vec3(0.85, 0.10, 0.55));

float wrapped(vec3 n, vec3 light, float wrap) {
  float d = max((dot(n, light) + wrap) / (1.0 + wrap), 0.0);
  return d * d * (1.0 - 0.5 * wrap) + d * 0.5 * wrap;
}

vec3 shade(vec3 albedo, vec3 n, vec3 view, float open) {
  float up = 0.5 + 0.5 * n.y;
  float grazing = 1.0 - max(dot(n, view), 0.0);
  if (is_matte) {
    vec3 ambient = mix(vec3(0.22, 0.21, 0.20), vec3(0.36, 0.37, 0.39), up);
    vec3 light = vec3(0.62 * wrapped(n, kKey, 0.6) + 0.16 * wrapped(n, kFill, 0.6)) + ambient * 0.95;
    return albedo * light * mix(0.5, 1.0, open) * (1.0 - 0.35 * grazing * grazing);
  }
  vec3 ambient = mix(vec3(0.13, 0.10, 0.085), vec3(0.27, 0.29, 0.33), up);
  // Light bounces between warm walls: what is closed in stays a little redder.
  vec3 closing = pow(vec3(open), vec3(1.25, 1.45, 1.6));
  vec3 light = vec3(1.18, 1.12, 1.03) * wrapped(n, kKey, 0.15) * mix(vec3(1.0), closing, 0.5) +
               vec3(0.14, 0.17, 0.22) * wrapped(n, kFill, 0.3) * closing + ambient * closing;
  float sheen = pow(max(dot(n, normalize(kKey + view)), 0.0), 36.0);
  float rim = grazing * grazing * grazing * (0.35 + 0.65 * up);
  return albedo * light + open * (vec3(0.09, 0.088, 0.085) * sheen + vec3(0.15, 0.16, 0.18) * rim);
}

vec3 to_srgb(vec3 linear) {
  linear = clamp(linear, 0.0, 1.0);
  return mix(12.92 * linear, 1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, linear));
}

void main() {
  ivec2 first = ivec2(gl_FragCoord.xy) * supersample;
  vec3 sum = vec3(0.0);
  float background = 0.0;
  float open = has_occlusion ? texelFetch(occlusions, ivec2(gl_FragCoord.xy), 0).x : 1.0;
  for (int i = 0; i < supersample * supersample; ++i) {
    ivec2 s = first + ivec2(i % supersample, i / supersample);
    vec3 p = position_at(s);
    if (p.z == 0.0) {
      background += 1.0;
      continue;
    }
    vec3 albedo = surface_color;
    if (has_colors) albedo = texelFetch(colors, s, 0).rgb / texelFetch(colors, s, 0).a;
    sum += shade(albedo, normal_at(s, p), -normalize(p), open);
  }
  float samples = float(supersample * supersample);
  vec3 behind = mix(background_top, background_bottom, gl_FragCoord.y / height);
  vec3 color = sum / samples;
  if (background > 0.0) color += behind * background / samples;
  // An ordered pattern of half a step of 8 bits, or the gradient shows its steps.
  ivec2 cell = ivec2(gl_FragCoord.xy) & 3;
  float dither = float(((cell.x ^ cell.y) & 1) * 8 + (cell.y & 1) * 4 + (((cell.x ^ cell.y) >> 1) & 1) * 2 + (cell.y >> 1));
  pixel_color = vec4(to_srgb(color) + ((dither + 0.5) / 16.0 - 0.5) / 255.0, 1.0);
}
)";

}  // namespace curvecast
