// SPDX-License-Identifier: Apache-2.0
// GLSL of the pass over the whole picture, which turns the sums of the discs into colours.

export const screenVertexShader = /* glsl */ `
precision highp float;
in vec3 position;
void main() { gl_Position = vec4(position.xy, 0.0, 1.0); }
`;

/// The visible surface at a pixel.
const surfaceFunctions = /* glsl */ `
precision highp float;
precision highp int;
uniform sampler2D normals;
uniform highp sampler2D depths;
uniform vec2 clip;         // distances of the near and far plane
uniform bool isParallel;   // the rays are
uniform vec2 halfSize;     // of the picture: at distance 1, or anywhere where rays are parallel
uniform float minKernel;   // sum of the kernels where the surface ends
uniform bool isCovered;    // the sums of the kernels are shares of the pixels that the surface covers

float distanceAt(ivec2 p) {
  float depth = texelFetch(depths, p, 0).x;
  return isParallel ? mix(clip.x, clip.y, depth) : clip.x * clip.y / (clip.y - depth * (clip.y - clip.x));
}

// Eye coordinates at a distance.
vec3 placeAt(ivec2 p, float distance) {
  vec2 size = vec2(textureSize(depths, 0));
  vec2 side = ((vec2(p) + 0.5) / size * 2.0 - 1.0) * halfSize;
  return isParallel ? vec3(side, -distance) : vec3(side, -1.0) * distance;
}

vec3 normalOf(vec3 sum, vec3 view) {
  float size = length(sum);
  vec3 n = size > 1e-7 ? sum / size : view;
  float facing = dot(n, view);
  if (facing >= 0.0) return n;
  // The normal of a back is turned round. Near the silhouette, a back is the rim of discs that stick out behind it: its normal is
  // mirrored, so that shading goes on as before the silhouette.
  return normalize(mix(n - 2.0 * facing * view, -n, smoothstep(0.75, 0.95, -facing)));
}
`;

export const shadeFragmentShader = /* glsl */ `
${surfaceFunctions}
uniform sampler2D colours;
uniform ivec2 origin;       // of the picture on the canvas
uniform float edlStrength;  // 0: none
uniform float edlReach;     // pixels
uniform float sceneRadius;
uniform vec3 clay, backTint, backgroundTop, backgroundBottom;  // linear light
uniform bool isMatte;
uniform vec4 brush;          // centre in eye coordinates, radius; 0: none
uniform bool closesGaps;     // between discs
uniform float surfaceShift;  // how far behind the surface its depths are, along the ray
layout(location = 0) out vec4 pixel;

// Eye coordinates: the lights move with the camera.
const vec3 kKey = normalize(vec3(-0.55, 0.75, 0.70));
const vec3 kFill = normalize(vec3(0.85, 0.10, 0.55));

float wrapped(vec3 n, vec3 light, float wrap) {
  float d = max((dot(n, light) + wrap) / (1.0 + wrap), 0.0);
  return d * d * (1.0 - 0.5 * wrap) + d * 0.5 * wrap;
}

vec3 shade(vec3 albedo, vec3 n, vec3 view) {
  float up = 0.5 + 0.5 * n.y;
  float grazing = 1.0 - max(dot(n, view), 0.0);
  if (isMatte) {
    vec3 ambient = mix(vec3(0.26, 0.255, 0.25), vec3(0.38, 0.385, 0.40), up);
    vec3 light = vec3(0.66 * wrapped(n, kKey, 0.6) + 0.18 * wrapped(n, kFill, 0.6)) + ambient;
    return albedo * light * (1.0 - 0.3 * grazing * grazing);
  }
  vec3 ambient = mix(vec3(0.13, 0.10, 0.085), vec3(0.27, 0.29, 0.33), up);
  vec3 light = vec3(1.18, 1.12, 1.03) * wrapped(n, kKey, 0.15) + vec3(0.14, 0.17, 0.22) * wrapped(n, kFill, 0.3) + ambient;
  float sheen = pow(max(dot(n, normalize(kKey + view)), 0.0), 36.0);
  float rim = grazing * grazing * grazing * (0.35 + 0.65 * up);
  return albedo * light + vec3(0.09, 0.088, 0.085) * sheen + vec3(0.15, 0.16, 0.18) * rim;
}

vec3 encoded(vec3 linear) {
  linear = clamp(linear, 0.0, 1.0);
  return mix(12.92 * linear, 1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, linear));
}

// Eye-dome lighting: how much of what is around stands before a pixel (Boucheny, "Interactive scientific visualization of large
// datasets: towards a perceptive-based approach", 2009).
float domeLight(ivec2 p, float here) {
  ivec2 last = textureSize(depths, 0) - 1;
  float scale = 1.0 / (0.06 * sceneRadius);
  float sum = 0.0;
  for (int i = 0; i < 8; ++i) {
    float angle = float(i) * 0.78539816;
    ivec2 tap = clamp(p + ivec2(round(edlReach * vec2(cos(angle), sin(angle)))), ivec2(0), last);
    float before = max(here - distanceAt(tap), 0.0) * scale;
    sum += before / (1.0 + before);
  }
  // A pixel behind all pixels around it is a gap between discs.
  return sum > 6.0 ? 1.0 : exp(-edlStrength * sum / 8.0);
}

// How much of a pixel the surface covers. At the rim the sums fall to nothing: their slope gives the distance to the edge.
float coverAt(ivec2 p, float kernel) {
  if (isCovered) return kernel;
  float cover = clamp((kernel - minKernel) / max(fwidth(kernel), 1e-4) + 0.5, 0.0, 1.0);
  if (kernel <= 0.0) return 0.0;
  if (cover == 1.0) return 1.0;
  ivec2 last = textureSize(normals, 0) - 1;
  for (int i = 0; i < 4; ++i) {
    ivec2 step = ivec2((i & 1) * 2 - 1, (i & 2) - 1);
    if (texelFetch(normals, clamp(p + step, ivec2(0), last), 0).w <= 0.0) return cover;
  }
  return 1.0;  // the surface goes on behind this edge
}

// Whether a pixel that is not covered is a gap between discs: a disc is there within two pixels on both sides, along all four lines
// through it but for one, along which it may be within four: behind low ridges, where it is seen from its edge, slits stay. (A gap
// between two parts of the surface goes on.) Any disc will do: where several just touch pixels around one, these are drawn as covered
// (coverAt), and it would be a hole in them. Sets nearest to the pixel that discs cover most.
bool isGap(ivec2 p, out ivec2 nearest) {
  ivec2 last = textureSize(normals, 0) - 1;
  nearest = p;
  float most = 0.0;
  int slits = 0;
  for (int i = 0; i < 4; ++i) {
    ivec2 along = i == 0 ? ivec2(1, 0) : i == 1 ? ivec2(0, 1) : i == 2 ? ivec2(1, 1) : ivec2(1, -1);
    bool isSlit = false;
    for (int side = -1; side <= 1; side += 2) {
      bool isThere = false;
      for (int step = 1; step <= 4 && !isThere; ++step) {
        ivec2 tap = clamp(p + side * step * along, ivec2(0), last);
        float kernel = texelFetch(normals, tap, 0).w;
        isThere = kernel > 0.0;
        if (isThere && step > 2) isSlit = true;
        if (isThere && kernel > most) {
          most = kernel;
          nearest = tap;
        }
      }
      if (!isThere) return false;
    }
    if (isSlit && ++slits > 1) return false;
  }
  return nearest != p;
}

void main() {
  ivec2 p = ivec2(gl_FragCoord.xy) - origin;
  vec4 sum = texelFetch(normals, p, 0);
  float height = (float(p.y) + 0.5) / float(textureSize(depths, 0).y);
  vec3 behind = mix(backgroundBottom, backgroundTop, height);
  float cover = coverAt(p, sum.w);
  ivec2 nearest;
  if (cover < 1.0 && closesGaps && isGap(p, nearest)) {
    p = nearest;
    sum = texelFetch(normals, p, 0);
    cover = 1.0;
  }
  vec3 colour = behind;
  if (cover > 0.0) {
    vec3 view = isParallel ? vec3(0.0, 0.0, 1.0) : -normalize(placeAt(p, 1.0));
    float here = distanceAt(p);
    vec3 n = normalOf(sum.xyz, view);
    // Rims of discs that stick out behind a sharp bend are not coloured as backs.
    float back = smoothstep(0.55, 0.85, -dot(sum.xyz, view) / max(length(sum.xyz), 1e-7));
#ifdef HAS_COLOURS
    vec4 colourSum = texelFetch(colours, p, 0);
    vec3 albedo = colourSum.rgb / max(colourSum.w, 1e-6);
    albedo *= mix(1.0, 0.45, back);
#else
    vec3 albedo = mix(clay, backTint, back);
#endif
    colour = shade(albedo, n, view);
    // Pixels between the smaller discs that make the depths have no depth.
    if (edlStrength > 0.0 && here < 0.999 * clip.y) colour *= domeLight(p, here);
    if (brush.w > 0.0) {
      vec3 surface = placeAt(p, here) + view * surfaceShift;
      float away = distance(surface, brush.xyz);
      float width = 1.5 * (isParallel ? 1.0 : here) * 2.0 * halfSize.y / float(textureSize(depths, 0).y);
      float inside = 1.0 - smoothstep(brush.w - width, brush.w + width, away);
      float ring = 1.0 - smoothstep(width, 2.0 * width, abs(away - brush.w));
      colour = mix(colour, vec3(0.95, 0.35, 0.05), 0.22 * inside + 0.7 * ring * (1.0 - 0.22 * inside));
    }
    colour = mix(behind, colour, cover);
  }
  // An ordered dither of half a step of 8 bits hides the steps of the gradient.
  ivec2 cell = ivec2(gl_FragCoord.xy) & 3;
  float dither = float(((cell.x ^ cell.y) & 1) * 8 + (cell.y & 1) * 4 + (((cell.x ^ cell.y) >> 1) & 1) * 2 + (cell.y >> 1));
  pixel = vec4(encoded(colour) + ((dither + 0.5) / 16.0 - 0.5) / 255.0, 1.0);
}
`;
