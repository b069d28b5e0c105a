#include "core/curve/surface_colour.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <span>

namespace curvecast {
namespace {

/// A colour to be mixed: the squares of its encoded values, nearly linear light; alpha as it is.
using Light = Eigen::Array4f;

Light to_light(const std::uint8_t* rgba) {
  const auto r = static_cast<float>(rgba[0]), g = static_cast<float>(rgba[1]), b = static_cast<float>(rgba[2]);
  return {r * r, g * g, b * b, static_cast<float>(rgba[3])};
}

Light to_light(const Rgba8& c) {
  const std::uint8_t rgba[] = {c.r, c.g, c.b, c.a};
  return to_light(rgba);
}

Rgba8 to_colour(const Light& light) {
  const auto byte = [](float value) { return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0f, 255.0f))); };
  return {byte(std::sqrt(light[0])), byte(std::sqrt(light[1])), byte(std::sqrt(light[2])), byte(light[3])};
}

/// Half as wide and high, but at least one texel; every texel is averaged into exactly one of the result.
Image halved(const Image& image) {
  Image half{std::max(1, image.width / 2), std::max(1, image.height / 2), {}};
  half.rgba.resize(std::size_t{4} * half.width * half.height);
  const auto begin_of = [](int i, int from, int to) { return static_cast<int>(std::int64_t{i} * from / to); };
  tbb::parallel_for(0, half.height, [&](int y) {
    const int y0 = begin_of(y, image.height, half.height), y1 = begin_of(y + 1, image.height, half.height);
    for (int x = 0; x < half.width; ++x) {
      const int x0 = begin_of(x, image.width, half.width), x1 = begin_of(x + 1, image.width, half.width);
      Light sum = Light::Zero();
      for (int v = y0; v < y1; ++v) {
        for (int u = x0; u < x1; ++u) sum += to_light(&image.rgba[4 * (std::size_t(v) * image.width + u)]);
      }
      const Rgba8 mean = to_colour(sum / static_cast<float>((x1 - x0) * (y1 - y0)));
      std::uint8_t* out = &half.rgba[4 * (std::size_t(y) * half.width + x)];
      out[0] = mean.r, out[1] = mean.g, out[2] = mean.b, out[3] = mean.a;
    }
  });
  return half;
}

/// Where `t` of a repeating row of n texels lies: between the middles of `first` and `second`.
struct Between {
  int first, second;
  float toward_second;
};

Between between_texels(double t, int n) {
  const double wrapped = std::isfinite(t) ? t - std::floor(t) : 0;
  const double place = wrapped * n - 0.5;
  const double below = std::floor(place);
  const int first = (static_cast<int>(below) + n) % n;
  return {first, (first + 1) % n, static_cast<float>(place - below)};
}

Light bilinear(const Image& image, const Vec2d& uv) {
  const Between x = between_texels(uv.x(), image.width);
  const Between y = between_texels(1 - uv.y(), image.height);  // rows run from top to bottom
  const auto texel = [&](int column, int row) { return to_light(&image.rgba[4 * (std::size_t(row) * image.width + column)]); };
  const Light upper = texel(x.first, y.first) * (1 - x.toward_second) + texel(x.second, y.first) * x.toward_second;
  const Light lower = texel(x.first, y.second) * (1 - x.toward_second) + texel(x.second, y.second) * x.toward_second;
  return upper * (1 - y.toward_second) + lower * y.toward_second;
}

Light trilinear(std::span<const Image* const> levels, const Vec2d& uv, double texels) {
  const auto last = static_cast<double>(levels.size() - 1);
  const double level = texels > 1 ? std::min(0.5 * std::log2(texels), last) : 0;
  const auto fine = static_cast<std::size_t>(level);
  const auto toward_coarse = static_cast<float>(level - static_cast<double>(fine));
  Light sharp = bilinear(*levels[fine], uv);
  if (toward_coarse == 0) return sharp;
  return sharp * (1 - toward_coarse) + bilinear(*levels[fine + 1], uv) * toward_coarse;
}

bool is_usable(const Material& material) { return material.texture != nullptr && !material.texture->rgba.empty(); }

}  // namespace

bool has_colour(const ColourView& attributes) {
  if (!attributes.colours.empty() || !attributes.face_colours.empty()) return true;
  if (attributes.material_of_face.empty()) return false;
  return std::any_of(attributes.materials.begin(), attributes.materials.end(), [&](const Material& material) {
    return (is_usable(material) && !attributes.uv.empty()) || material.colour != Rgba8{};
  });
}

SurfaceColour::SurfaceColour(const MeshView& mesh, const ColourView& attributes) : mesh_(mesh), attributes_(attributes) {
  std::map<const Image*, std::size_t> index_of;
  std::vector<const Image*> images;
  constexpr std::size_t kNoTexture = SIZE_MAX;
  for (const Material& material : attributes.materials) {
    texture_of_material_.push_back(kNoTexture);
    if (!is_usable(material) || attributes.uv.empty()) continue;
    const auto [known, is_new] = index_of.try_emplace(material.texture.get(), images.size());
    if (is_new) images.push_back(material.texture.get());
    texture_of_material_.back() = known->second;
  }
  for (const Image* image : images) {
    std::vector<Image>& reduced = reduced_.emplace_back();
    for (const Image* finest = image; finest->width > 1 || finest->height > 1; finest = &reduced.back()) {
      reduced.push_back(halved(*finest));
    }
    Levels& levels = textures_.emplace_back(1, image);
    for (const Image& level : reduced) levels.push_back(&level);
  }
}

const SurfaceColour::Levels* SurfaceColour::texture_of(std::uint32_t face) const {
  if (attributes_.material_of_face.empty()) return nullptr;
  const std::uint32_t material = attributes_.material_of_face[face];
  if (material >= texture_of_material_.size() || texture_of_material_[material] >= textures_.size()) return nullptr;
  return &textures_[texture_of_material_[material]];
}

Rgba8 SurfaceColour::at(std::uint32_t face, const Vec3f& weights, double area) const {
  Light light = to_light(Rgba8{});
  if (const Levels* levels = texture_of(face); levels != nullptr) {
    const Vec2d a = attributes_.uv[3 * std::size_t{face}].cast<double>();
    const Vec2d b = attributes_.uv[3 * std::size_t{face} + 1].cast<double>();
    const Vec2d c = attributes_.uv[3 * std::size_t{face} + 2].cast<double>();
    const Vec2d ab = b - a, ac = c - a;
    const Image& finest = *levels->front();
    const double texels_of_face = 0.5 * std::abs(ab.x() * ac.y() - ab.y() * ac.x()) * finest.width * finest.height;
    const double texels = area > 0 ? texels_of_face * area / triangle_area(mesh_, face) : 0;
    const Vec3d w = weights.cast<double>();
    light = trilinear(*levels, w[0] * a + w[1] * b + w[2] * c, texels);
  } else if (!attributes_.colours.empty()) {
    const Triangle& v = mesh_.triangles[face];
    light = Light::Zero();
    for (int corner = 0; corner < 3; ++corner) light += weights[corner] * to_light(attributes_.colours[v[corner]]);
  } else if (!attributes_.face_colours.empty()) {
    light = to_light(attributes_.face_colours[face]);
  }
  if (!attributes_.material_of_face.empty()) {
    const std::uint32_t material = attributes_.material_of_face[face];
    if (material < attributes_.materials.size()) {
      const Light white = to_light(Rgba8{});
      light *= to_light(attributes_.materials[material].colour) / white;
    }
  }
  return to_colour(light);
}

}  // namespace curvecast
