// The GLSL of the passes that draw splats and dots. Internal to core/render.
//
// Pictures are drawn upside down for GL, so that the first row read back is the top one.
#pragma once

namespace curvecast {

inline constexpr char kSplatVertexShader[] = R"(#version 330 core
layout(location = 0) in vec4 center_radius;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 color;
layout(location = 3) in vec4 end_1;
layout(location = 4) in vec4 end_2;
uniform vec4 projection;    // x and y scale, z scale and offset
uniform float back_shift;   // along the ray, in radii
uniform float extent;       // of the disc that is drawn, in radii
uniform float min_extent;   // at distance 1
out vec2 disc;
out vec2 beyond;  // the planes at which the disc ends, where that is above 0
out float depth;
flat out vec4 splat_normal;  // w: weight of the splat
flat out vec3 splat_color;

void main() {
  vec3 center = center_radius.xyz;
  if (center.z >= 0.0) {  // behind the eye
    gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
    return;
  }
  vec3 view = -normalize(center);
  vec3 n = dot(normal, normal) > 0.0 ? normal : view;
  float facing = dot(n, view);
  vec3 lean = n - facing * view;  // where the disc leans, seen by the eye
  if (dot(lean, lean) < 1e-8) lean = cross(view, abs(view.x) < 0.7 ? vec3(1, 0, 0) : vec3(0, 1, 0));
  lean = normalize(lean);
  vec3 major = cross(view, lean);
  vec3 minor = cross(n, major);
  float least = min_extent * -center.z;
  float radius = max(center_radius.w, least);
  // A disc thinner than a sample turns a little to the eye: it is never lost between samples.
  float lost = max(least - radius * abs(facing), 0.0);
  minor = radius * minor - (facing < 0.0 ? -lost : lost) * lean;
  disc = extent * vec2((gl_VertexID & 1) * 2 - 1, (gl_VertexID & 2) - 1);
  vec3 p = center + disc.x * minor + disc.y * radius * major;
  depth = -p.z;
  beyond = vec2(dot(end_1.xyz, p) - end_1.w, dot(end_2.xyz, p) - end_2.w);
  p *= 1.0 + back_shift * radius / length(p);
  gl_Position = vec4(projection.xy * p.xy, projection.z * p.z + projection.w, -p.z);
  // Back faces count only where nothing faces the eye: through the holes of an open surface, not behind its rim.
  splat_normal = vec4(n, mix(0.002, 1.0, smoothstep(-0.15, 0.15, facing)));
  splat_color = color.rgb;
}
)";

inline constexpr char kDepthFragmentShader[] = R"(#version 330 core
in vec2 disc;
in vec2 beyond;
uniform float extent;
void main() {
  if (dot(disc, disc) > extent * extent || max(beyond.x, beyond.y) > 0.0) discard;
}
)";

// Compiled with HAS_COLORS defined or not.
inline constexpr char kBlendFragmentShader[] = R"(
in vec2 disc;
in vec2 beyond;
in float depth;
flat in vec4 splat_normal;
flat in vec3 splat_color;
uniform float extent;
layout(location = 0) out vec4 normal_sum;  // w: sum of the kernels, whichever way they face
layout(location = 1) out vec2 depth_sum;   // y: sum of the weights
#ifdef HAS_COLORS
layout(location = 2) out vec4 color_sum;
#endif
void main() {
  float t = 1.0 - dot(disc, disc) / (extent * extent);
  if (t <= 0.0 || max(beyond.x, beyond.y) > 0.0) discard;
  float kernel = t * t * t;  // like a Gaussian, and 0 at the edge
  float weight = splat_normal.w * kernel;
  // What is seen on the surface comes from a narrower kernel than its shape: blurred less, and still smooth.
  float sharp = weight * kernel;
  normal_sum = vec4(splat_normal.xyz * sharp, kernel);
  depth_sum = vec2(depth * weight, weight);
#ifdef HAS_COLORS
  color_sum = vec4(splat_color * splat_color * sharp, sharp);  // squares: nearly linear light
#endif
}
)";

// Dots are kept or hidden as a whole: the surface never cuts through one.
inline constexpr char kDotVertexShader[] = R"(#version 330 core
layout(location = 0) in vec3 center;
layout(location = 1) in vec4 color;
uniform sampler2D normals;
uniform sampler2D depths;
uniform vec4 projection;
uniform float diameter;   // pixels
uniform float tolerance;  // of depth
uniform float least_kernel;
flat out vec3 dot_color;

void main() {
  gl_Position = vec4(projection.xy * center.xy, projection.z * center.z + projection.w, -center.z);
  gl_PointSize = diameter + 1.0;
  dot_color = color.rgb;
  ivec2 size = textureSize(normals, 0);
  ivec2 s = ivec2(floor((0.5 + 0.5 * gl_Position.xy / gl_Position.w) * vec2(size)));
  float farthest = 0.0;
  for (int y = -1; y <= 1; ++y) {
    for (int x = -1; x <= 1; ++x) {
      ivec2 t = clamp(s + ivec2(x, y), ivec2(0), size - 1);
      if (texelFetch(normals, t, 0).w < least_kernel) continue;
      vec2 sum = texelFetch(depths, t, 0).xy;
      farthest = max(farthest, sum.x / sum.y);
    }
  }
  bool is_hidden = farthest > 0.0 && -center.z > farthest + tolerance;
  if (is_hidden || center.z >= 0.0) gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
}
)";

inline constexpr char kDotFragmentShader[] = R"(#version 330 core
uniform float diameter;
flat in vec3 dot_color;
layout(location = 0) out vec4 pixel_color;
void main() {
  float distance = length(gl_PointCoord - 0.5) * (diameter + 1.0);
  float cover = clamp(0.5 * diameter - distance + 0.5, 0.0, 1.0);
  if (cover <= 0.0) discard;
  pixel_color = vec4(dot_color, cover);
}
)";

}  // namespace curvecast
