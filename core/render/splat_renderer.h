// Draws point clouds as smooth closed surfaces, in software (OSMesa).
//
// Surface splatting in three passes: visibility of the tilted discs, Gaussian-weighted blending of what lies near the visible
// surface, shading per pixel. Zwicker, Pfister, van Baar, Gross, "Surface Splatting", SIGGRAPH 2001; Botsch, Hornung, Zwicker,
// Kobbelt, "High-Quality Surface Splatting on Today's GPUs", PBG 2005.
#pragma once

#include <absl/status/statusor.h>

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/image.h"
#include "core/base/vec.h"
#include "core/render/render_camera.h"

namespace curvecast {

using Rgb8 = std::array<std::uint8_t, 3>;  // sRGB

/// N splats; the other spans hold N elements or none.
struct SplatCloud {
  std::span<const Vec3f> positions;  // mesh units
  std::span<const Vec3f> normals;    // any length; none, or a zero vector: the disc faces the camera
  std::span<const float> radii;      // mesh units, >= 0; none: sqrt(area of the bounding box / N) for all
  std::span<const Rgb8> colors;      // of the surface in kSurface, of the dots in kDots
  double crease_degrees = 40;        // discs end where the surface turns by more, 0 .. 180
};

enum class RenderMode {
  kSurface,  // the shaded surface alone
  kDots,     // the visible points as small round dots on a pale surface
};

struct RenderOptions {
  int width = 1280, height = 960;  // pixels, >= 1
  int supersample = 2;             // samples per pixel along each axis, 1 .. 4; width and height times this <= 16384 each, and
                                   // <= 2^26 samples in all (32 to 40 bytes of memory per sample)
  RenderMode mode = RenderMode::kSurface;
  double radius_scale = 1;  // times every radius, > 0
  double dot_diameter = 5;  // pixels, 1 .. 64
  bool ambient_occlusion = true;
  bool matte_under_dots = true;       // kDots: the surface hardly shaded, so that the dots stand out; else as in kSurface
  std::optional<Rgb8> surface_color;  // none: clay in kSurface, nearly white in kDots
  Rgb8 dot_color = {20, 24, 34};
  Rgb8 background_top = {250, 251, 252}, background_bottom = {205, 211, 219};
};

/// Neighbouring discs should overlap: a radius of the spacing of evenly spread points makes the surface smooth, 0.7 of it still
/// leaves no hole. Where neighbours' normals differ by more than `crease_degrees`, both discs end along the line where their
/// planes meet: edges are sharp. A disc without neighbours shows up to 0.8 of its radius. Without any normals they are taken from
/// the depths. Two-sided: the back of an open surface is shaded too. Hidden dots are those behind the splatted surface. With
/// `dots`, kDots draws these points, in `dot_colors` where there are any, instead of the cloud's own, which then only makes the
/// surface: a dense cloud under a sparse point set.
///
/// InvalidArgument for an empty cloud, spans of other lengths, coordinates that are not finite, options out of range or a camera
/// without a direction; ResourceExhausted or Internal when OSMesa refuses. Deterministic on one machine. May be called from any
/// thread; leaves no OSMesa context current on it.
absl::StatusOr<Image> render_splats(const SplatCloud& cloud, const RenderCamera& camera, const RenderOptions& options = {},
                                    std::span<const Vec3f> dots = {}, std::span<const Rgb8> dot_colors = {});

}  // namespace curvecast
