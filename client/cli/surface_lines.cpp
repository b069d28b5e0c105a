#include "client/cli/surface_lines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/render/curve_renderer.h"

namespace curvecast::cli {
namespace {

constexpr double kDotsPerPixel = 2;
// Of the distance between two dots, in diagonals of what is drawn: a close-up must not take all memory.
constexpr double kSmallestStep = 2e-5;

constexpr double kLeastFacing = 0.06;  // of a closed surface: the cosine between its normal and the direction to the eye

bool comes_first(const Vec3d& a, const Vec3d& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

/// Sets dots at the distances that a view asks for.
class Tracer {
 public:
  explicit Tracer(const LineView& view)
      : view_(view),
        pixel_at_one_(2 * std::tan(view.camera.vertical_fov_degrees * std::numbers::pi / 360) / view.height),
        smallest_(kSmallestStep * view.diagonal) {}

  /// From place(0) to place(1), which lie `length` apart. Without those that is_hidden(t, place(t)).
  template <typename Place, typename IsHidden>
  void line(double length, const Rgb8& color, Place&& place, IsHidden&& is_hidden) {
    for (double along = 0; along <= length;) {
      const double t = length > 0 ? along / length : 0;
      const Vec3d p = place(t);
      if (!is_hidden(t, p)) {
        dots_.positions.emplace_back((p - view_.origin).template cast<float>());
        dots_.colors.push_back(color);
      }
      const double step = std::max(pixel_at_one_ * (p - view_.camera.eye).norm() / kDotsPerPixel, smallest_);
      if (!(step > 0)) break;
      along += step;
    }
  }
  void line(const Vec3d& a, const Vec3d& b, const Rgb8& color) {
    line((b - a).norm(), color, [&](double t) { return Vec3d(a + (b - a) * t); }, [](double, const Vec3d&) { return false; });
  }

  LineDots take() { return std::move(dots_); }

 private:
  const LineView& view_;
  const double pixel_at_one_, smallest_;
  LineDots dots_;
};

/// Where `p` meets the plane through `on` with the given normal, along the normal.
Vec3d onto_plane(const Vec3d& p, const Vec3d& on, const Vec3d& normal) { return p - normal * normal.dot(p - on); }

}  // namespace

LineDots trace_cuts(const client::ParameterMesh& mesh, const LineView& view) {
  Tracer tracer(view);
  for (const client::ParameterDisc& disc : mesh.discs) {
    for (std::size_t i = 0; i < disc.border.size(); ++i) {
      const Vec3d a(disc.positions[disc.border[i]].data());
      const Vec3d b(disc.positions[disc.border[(i + 1) % disc.border.size()]].data());
      const bool is_cut = disc.border_cuts[i] != 0;
      if (is_cut && comes_first(b, a)) continue;  // the other side draws it
      tracer.line(a, b, is_cut ? kCutColor : kBorderColor);
    }
  }
  return tracer.take();
}

LineDots trace_edges(const client::ParameterMesh& mesh, const LineView& view) {
  // By place, not by vertex: both sides of a cut have vertices of their own.
  std::vector<std::array<std::array<double, 3>, 2>> edges;
  for (const client::ParameterDisc& disc : mesh.discs) {
    for (const auto& t : disc.triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        const auto &a = disc.positions[t[k]], &b = disc.positions[t[(k + 1) % 3]];
        edges.push_back({std::min(a, b), std::max(a, b)});
      }
    }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  Tracer tracer(view);
  for (const auto& [a, b] : edges) tracer.line(Vec3d(a.data()), Vec3d(b.data()), kEdgeColor);
  return tracer.take();
}

LineDots trace_curve(const client::Curve& curve, const LineView& view) {
  const Vec3d origin(curve.info.origin().x(), curve.info.origin().y(), curve.info.origin().z());
  Tracer tracer(view);
  for (const client::CurveDisc& disc : curve.discs) {
    const auto place = [&](std::size_t l) {
      return Vec3d(origin + Vec3d(disc.positions[l][0], disc.positions[l][1], disc.positions[l][2]));
    };
    const auto normal = [&](std::size_t l) {
      return Vec3d(disc.normals[l][0], disc.normals[l][1], disc.normals[l][2]).stableNormalized();
    };
    const double last = std::max<double>(1, static_cast<double>(disc.size()) - 1);
    for (std::size_t l = 0; l + 1 < disc.size(); ++l) {
      const Vec3d a = place(l), b = place(l + 1), na = normal(l), nb = normal(l + 1);
      // Phong tessellation (Boubekeur, Alexa 2008): half of the way to the planes that touch the surface at both ends, which on a
      // sphere is the sphere, so that the line does not dive into a round surface.
      const auto bent = [&](double t) {
        const Vec3d p = a + (b - a) * t;
        return Vec3d(0.5 * p + 0.5 * ((1 - t) * onto_plane(p, a, na) + t * onto_plane(p, b, nb)));
      };
      // Along the silhouette lines would stick out.
      const auto faces_away = [&](double t, const Vec3d& p) {
        const Vec3d to_eye = view.camera.eye - p;
        return view.is_closed && ((1 - t) * na + t * nb).dot(to_eye) < kLeastFacing * to_eye.norm();
      };
      tracer.line((b - a).norm(), curve_colour((static_cast<double>(l) + 0.5) / last), bent, faces_away);
    }
  }
  return tracer.take();
}

}  // namespace curvecast::cli
