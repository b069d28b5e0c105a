#include "core/measure/ball_discrepancy.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/base/random.h"
#include "core/measure/area_in_ball.h"
#include "core/measure/kd_order.h"
#include "core/measure/random_surface_points.h"

namespace curvecast {
namespace {

struct Sphere {
  Vec3d middle;
  double radius;
};

/// Holds them all, with a little room for rounding.
Sphere sphere_about(std::span<const Sphere> spheres) {
  Box3d box;
  for (const auto& [middle, radius] : spheres) {
    box.extend(middle - Vec3d::Constant(radius));
    box.extend(middle + Vec3d::Constant(radius));
  }
  Sphere all{box.center(), 0};
  for (const auto& [middle, radius] : spheres) all.radius = std::max(all.radius, (middle - all.middle).norm() + radius);
  all.radius += 1e-14 * (box.min.cwiseAbs() + box.max.cwiseAbs()).sum();
  return all;
}

/// Spheres about runs of things, about eight neighbouring ones of those, and so on.
class SphereTree {
 public:
  explicit SphereTree(std::vector<Sphere> of_runs) : levels_{std::move(of_runs)} {
    while (levels_.back().size() > 1) {
      std::vector<Sphere> next;
      std::span<const Sphere> below = levels_.back();
      for (; !below.empty(); below = below.subspan(std::min(kFanOut, below.size()))) {
        next.push_back(sphere_about(below.first(std::min(kFanOut, below.size()))));
      }
      levels_.push_back(std::move(next));
    }
  }

  /// For balls about the centre, radii ascending: whole(k, begin, end) where ball k holds runs [begin, end) altogether, part(k,
  /// run) where it cuts one or nearly so.
  template <typename Whole, typename Part>
  void visit(const Vec3d& centre, std::span<const double> radii, Whole&& whole, Part&& part) const {
    visit(levels_.size() - 1, 0, centre, radii, 0, radii.size(), whole, part);
  }

 private:
  static constexpr std::size_t kFanOut = 8;

  template <typename Whole, typename Part>
  void visit(std::size_t level, std::size_t node, const Vec3d& centre, std::span<const double> radii, std::size_t first,
             std::size_t last, Whole& whole, Part& part) const {
    const Sphere& sphere = levels_[level][node];
    const double distance = (sphere.middle - centre).norm();
    while (first < last && radii[first] < distance - sphere.radius) ++first;
    for (; first < last && radii[last - 1] > distance + sphere.radius; --last) {
      const std::size_t begin = node << (3 * level);
      whole(last - 1, begin, std::min(begin + (std::size_t{1} << (3 * level)), levels_[0].size()));
    }
    if (first == last) return;
    if (level == 0) {
      for (std::size_t k = first; k < last; ++k) part(k, node);
      return;
    }
    for (std::size_t c = node * kFanOut; c < std::min((node + 1) * kFanOut, levels_[level - 1].size()); ++c) {
      visit(level - 1, c, centre, radii, first, last, whole, part);
    }
  }

  std::vector<std::vector<Sphere>> levels_;
};

class PointRuns {
 public:
  explicit PointRuns(std::span<const Vec3d> points) : runs_(points.size(), kRun), tree_(fill(points)) {}

  /// Adds what each ball holds to `inside`.
  void count(const Vec3d& centre, std::span<const double> radii, std::span<std::size_t> inside) const {
    tree_.visit(
        centre, radii,
        [&](std::size_t k, std::size_t begin, std::size_t end) { inside[k] += runs_.begin(end) - runs_.begin(begin); },
        [&](std::size_t k, std::size_t run) {
          const double square = radii[k] * radii[k];
          std::size_t count = 0;
          for (std::size_t i = runs_.begin(run), end = runs_.end(run); i < end; ++i) {
            const double dx = x_[i] - centre.x(), dy = y_[i] - centre.y(), dz = z_[i] - centre.z();
            count += dx * dx + dy * dy + dz * dz <= square;
          }
          inside[k] += count;
        });
  }

 private:
  static constexpr std::size_t kRun = 32;

  std::vector<Sphere> fill(std::span<const Vec3d> points) {
    const std::vector<std::uint32_t> order = kd_order(points, kRun);
    std::vector<Sphere> spheres, own;
    for (std::size_t run = 0; run < runs_.count; ++run) {
      own.clear();
      for (std::size_t i = runs_.begin(run); i < runs_.end(run); ++i) {
        const Vec3d& p = points[order[i]];
        own.push_back({p, 0});
        x_.push_back(p.x());
        y_.push_back(p.y());
        z_.push_back(p.z());
      }
      spheres.push_back(sphere_about(own));
    }
    return spheres;
  }

  Runs runs_;
  std::vector<double> x_, y_, z_;
  SphereTree tree_;
};

/// Triangles, with the measure that is to be counted.
class FaceRuns {
 public:
  FaceRuns(const TriangleMesh& mesh, std::span<const double> density)
      : runs_(mesh.face_count(), kRun), tree_(fill(mesh, density)) {}

  double total() const { return mass_up_to_.back(); }

  /// Adds what each ball holds to `inside`.
  void measure(const Vec3d& centre, std::span<const double> radii, std::span<double> inside) const {
    tree_.visit(
        centre, radii,
        [&](std::size_t k, std::size_t begin, std::size_t end) { inside[k] += mass_up_to_[end] - mass_up_to_[begin]; },
        [&](std::size_t k, std::size_t run) {
          for (std::size_t i = runs_.begin(run), end = runs_.end(run); i < end; ++i) {
            const Face& face = faces_[i];
            const double distance = (face.around.middle - centre).norm();
            if (radii[k] < distance - face.around.radius) continue;
            const auto& [a, b, c] = face.corners;
            inside[k] +=
                radii[k] > distance + face.around.radius ? face.mass : face.density * area_in_ball(centre, radii[k], a, b, c);
          }
        });
  }

 private:
  static constexpr std::size_t kRun = 8;
  struct Face {
    Sphere around;
    Vec3d corners[3];
    double density, mass;
  };

  std::vector<Sphere> fill(const TriangleMesh& mesh, std::span<const double> density) {
    std::vector<Vec3d> middles(mesh.face_count());
    for (std::size_t f = 0; f < middles.size(); ++f) {
      const Triangle& t = mesh.triangles[f];
      middles[f] = (mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3;
    }
    const std::vector<std::uint32_t> order = kd_order(middles, kRun);
    std::vector<Sphere> spheres, own;
    for (std::size_t run = 0; run < runs_.count; ++run) {
      own.clear();
      double mass = 0;
      for (std::size_t i = runs_.begin(run); i < runs_.end(run); ++i) {
        Face& face = faces_.emplace_back();
        for (int c = 0; c < 3; ++c) face.corners[c] = mesh.positions[mesh.triangles[order[i]][c]];
        const auto& [p, q, r] = face.corners;
        face.around = sphere_about(std::array<Sphere, 3>{{{p, 0}, {q, 0}, {r, 0}}});
        face.density = density.empty() ? 1 : density[order[i]];
        face.mass = face.density * triangle_area(mesh, order[i]);
        mass += face.mass;
        own.push_back(face.around);
      }
      mass_up_to_.push_back(mass_up_to_.back() + mass);
      spheres.push_back(sphere_about(own));
    }
    return spheres;
  }

  Runs runs_;
  std::vector<Face> faces_;
  std::vector<double> mass_up_to_ = {0};  // of all runs before each, and of all
  SphereTree tree_;
};

}  // namespace

BallDiscrepancy::BallDiscrepancy(const TriangleMesh& mesh, const BallOptions& options, std::span<const double> face_density,
                                 const ExecutionContext& context)
    : radii_(static_cast<std::size_t>(options.radii)) {
  centres_ = random_surface_points(mesh, static_cast<std::size_t>(options.centres), options.seed).positions;
  radius_.resize(centres_.size() * radii_);
  shares_.resize(radius_.size());
  const FaceRuns faces(mesh, face_density);
  const std::uint64_t radius_seed = mix_bits(options.seed);
  tbb::parallel_for(std::size_t{0}, centres_.size(), [&](std::size_t c) {
    if (context.cancelled()) return;
    double reach = 0;
    for (const Vec3d& p : mesh.positions) reach = std::max(reach, (p - centres_[c]).squaredNorm());
    reach = std::sqrt(reach);
    const std::span<double> radii = std::span(radius_).subspan(c * radii_, radii_);
    const std::span<double> shares = std::span(shares_).subspan(c * radii_, radii_);
    for (std::size_t k = 0; k < radii_; ++k) {
      radii[k] = reach * (static_cast<double>(k) + random_unit(radius_seed, c * radii_ + k)) / static_cast<double>(radii_);
    }
    faces.measure(centres_[c], radii, shares);
    for (double& share : shares) share = std::min(share / faces.total(), 1.0);
  });
}

Discrepancy BallDiscrepancy::of(std::span<const Vec3d> points) const {
  const PointRuns runs(points);
  std::vector<std::size_t> inside(radius_.size());
  tbb::parallel_for(std::size_t{0}, centres_.size(), [&](std::size_t c) {
    runs.count(centres_[c], std::span(radius_).subspan(c * radii_, radii_), std::span(inside).subspan(c * radii_, radii_));
  });
  const auto n = static_cast<double>(points.size());
  DiscrepancySum sum;
  for (std::size_t b = 0; b < inside.size(); ++b) sum.add(static_cast<double>(inside[b]) / n, shares_[b]);
  return sum.result(n);
}

}  // namespace curvecast
