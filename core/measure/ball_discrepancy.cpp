#include "core/measure/ball_discrepancy.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/measure/area_in_ball.h"
#include "core/measure/kd_order.h"
#include "core/measure/random_surface_points.h"
#include "core/sample/random.h"

namespace curvecast {
namespace {

struct Sphere {
  Vec3d middle;
  double radius;
};

/// Holds them all, with a little room for rounding.
Sphere sphere_about(std::span<const Vec3d> points) {
  Box3d box;
  for (const Vec3d& p : points) box.extend(p);
  double square = 0;
  for (const Vec3d& p : points) square = std::max(square, (p - box.center()).squaredNorm());
  return {box.center(), std::sqrt(square) + 1e-14 * (box.min.cwiseAbs() + box.max.cwiseAbs()).sum()};
}

/// For every ball about the centre: whole(run, k) where it holds the sphere of a run, part(run, k) where it cuts it.
template <typename Whole, typename Part>
void visit_runs(const std::vector<Sphere>& runs, const Vec3d& centre, std::span<const double> radii, Whole&& whole, Part&& part) {
  for (std::size_t run = 0; run < runs.size(); ++run) {
    const double distance = (runs[run].middle - centre).norm();
    for (std::size_t k = 0; k < radii.size(); ++k) {
      if (radii[k] < distance - runs[run].radius) continue;
      if (radii[k] > distance + runs[run].radius) {
        whole(run, k);
      } else {
        part(run, k);
      }
    }
  }
}

/// Points in runs of neighbours, so that a ball takes or leaves most of them a run at once.
class PointRuns {
 public:
  explicit PointRuns(std::span<const Vec3d> points) : runs_(points.size(), kRun) {
    const std::vector<std::uint32_t> order = kd_order(points, kRun);
    std::vector<Vec3d> own;
    for (std::size_t run = 0; run < runs_.count; ++run) {
      own.clear();
      for (std::size_t i = runs_.begin(run); i < runs_.end(run); ++i) {
        const Vec3d& p = own.emplace_back(points[order[i]]);
        x_.push_back(p.x());
        y_.push_back(p.y());
        z_.push_back(p.z());
      }
      spheres_.push_back(sphere_about(own));
    }
  }

  /// Adds what each ball holds to `inside`.
  void count(const Vec3d& centre, std::span<const double> radii, std::span<std::size_t> inside) const {
    visit_runs(
        spheres_, centre, radii, [&](std::size_t run, std::size_t k) { inside[k] += runs_.end(run) - runs_.begin(run); },
        [&](std::size_t run, std::size_t k) {
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
  static constexpr std::size_t kRun = 64;
  Runs runs_;
  std::vector<double> x_, y_, z_;
  std::vector<Sphere> spheres_;  // of the runs
};

/// Triangles in runs of neighbours, with the measure that is to be counted.
class FaceRuns {
 public:
  FaceRuns(const TriangleMesh& mesh, std::span<const double> density) : runs_(mesh.face_count(), kRun) {
    std::vector<Vec3d> middles(mesh.face_count());
    for (std::size_t f = 0; f < middles.size(); ++f) {
      const Triangle& t = mesh.triangles[f];
      middles[f] = (mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3;
    }
    const std::vector<std::uint32_t> order = kd_order(middles, kRun);
    std::vector<Vec3d> own;
    for (std::size_t run = 0; run < runs_.count; ++run) {
      own.clear();
      double mass = 0;
      for (std::size_t i = runs_.begin(run); i < runs_.end(run); ++i) {
        const Triangle& t = mesh.triangles[order[i]];
        for (const std::uint32_t v : t) own.push_back(mesh.positions[v]);
        const double area = triangle_area(mesh, order[i]);
        Face& face = faces_.emplace_back();
        face.around = sphere_about(std::span(own).last(3));
        std::copy_n(own.end() - 3, 3, face.corners);
        face.density = density.empty() ? 1 : density[order[i]];
        face.mass = face.density * area;
        mass += face.mass;
      }
      spheres_.push_back(sphere_about(own));
      masses_.push_back(mass);
      total_ += mass;
    }
  }

  double total() const { return total_; }

  /// Adds what each ball holds to `inside`.
  void measure(const Vec3d& centre, std::span<const double> radii, std::span<double> inside) const {
    visit_runs(
        spheres_, centre, radii, [&](std::size_t run, std::size_t k) { inside[k] += masses_[run]; },
        [&](std::size_t run, std::size_t k) {
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
  static constexpr std::size_t kRun = 16;
  struct Face {
    Sphere around;
    Vec3d corners[3];
    double density, mass;
  };

  Runs runs_;
  std::vector<Face> faces_;
  std::vector<Sphere> spheres_;  // of the runs
  std::vector<double> masses_;   // of the runs
  double total_ = 0;
};

}  // namespace

BallDiscrepancy::BallDiscrepancy(const TriangleMesh& mesh, const BallOptions& options, std::span<const double> face_density)
    : radii_(static_cast<std::size_t>(options.radii)) {
  centres_ = random_surface_points(mesh, static_cast<std::size_t>(options.centres), options.seed).positions;
  radius_.resize(centres_.size() * radii_);
  shares_.resize(radius_.size());
  const FaceRuns faces(mesh, face_density);
  const std::uint64_t radius_seed = mix_bits(options.seed);
  tbb::parallel_for(std::size_t{0}, centres_.size(), [&](std::size_t c) {
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
