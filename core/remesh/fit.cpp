#include "core/remesh/fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "core/base/for_all.h"
#include "core/remesh/unfold.h"

namespace curvecast {
namespace {

constexpr char kStage[] = "fit";
constexpr int kRounds = 3;
constexpr int kMostSteps = 30;    // of conjugate gradients
constexpr double kEnough = 1e-3;  // of the first residual
// What holds a vertex where it was, over what moves it along normals: this times the mean squared sine between the normals of
// both. Coarse triangles see normals of many directions, which pull vertices along the surface, too.
constexpr double kHold = 0.25, kLeastDeviation = 1e-3;
constexpr double kLeastAngle = 20;  // degrees
constexpr int kHalvings = 3;
constexpr int kMostParts = 8;  // of a triangle's side
constexpr double kPlacesPerFace = 1.5;
constexpr std::size_t kGrain = 1024;  // triangles or vertices

/// A symmetric matrix of three rows, for what only adds up: xx, xy, xz, yy, yz, zz.
struct Symmetric {
  std::array<float, 6> m{};

  void add(const Vec3d& n, double weight) {
    const Vec3d w = weight * n;
    const double terms[] = {w[0] * n[0], w[0] * n[1], w[0] * n[2], w[1] * n[1], w[1] * n[2], w[2] * n[2]};
    for (int i = 0; i < 6; ++i) m[i] += static_cast<float>(terms[i]);
  }
  void add(const Symmetric& other) {
    for (int i = 0; i < 6; ++i) m[i] += other.m[i];
  }
  Vec3d times(const Vec3d& x) const {
    const std::array<double, 6> d{m[0], m[1], m[2], m[3], m[4], m[5]};
    return {d[0] * x[0] + d[1] * x[1] + d[2] * x[2], d[1] * x[0] + d[3] * x[1] + d[4] * x[2],
            d[2] * x[0] + d[4] * x[1] + d[5] * x[2]};
  }
  Eigen::Matrix3d full() const {
    Eigen::Matrix3d out;
    out << m[0], m[1], m[2], m[1], m[3], m[4], m[2], m[4], m[5];
    return out;
  }
};

class Fitter {
 public:
  Fitter(HalfedgeMesh& mesh, const SurfaceWalk& surface, std::span<const WalkPlace> places, const ExecutionContext& context)
      : mesh_(mesh),
        surface_(surface),
        context_(context),
        stays_(mesh.vertex_count()),
        start_(mesh.positions),
        weights_(places_in_triangles()),
        mean_area_(surface_area(mesh) / static_cast<double>(mesh.face_count())) {
    for (std::uint32_t v = 0; v < stays_.size(); ++v) stays_[v] = mesh.on_line(v);
    foot_.reserve(mesh.face_count());
    for (const Triangle& t : mesh.triangles) foot_.push_back(places[t[0]].face);
  }

  void run() {
    for (int round = 0; round < kRounds && !context_.cancelled(); ++round) {
      context_.progress(kStage, static_cast<double>(round) / kRounds);
      look();
      gather();
      solve();
      if (!context_.cancelled()) move();
    }
  }

 private:
  /// Weights of corners for the middles of a triangle's parts: as many as give the whole mesh enough places.
  std::vector<Vec3d> places_in_triangles() const {
    const double wanted = kPlacesPerFace * static_cast<double>(surface_.face_count()) / static_cast<double>(mesh_.face_count());
    const int parts = std::clamp(static_cast<int>(std::ceil(std::sqrt(wanted))), 2, kMostParts);
    std::vector<Vec3d> weights;
    const auto add = [&](double u, double v) { weights.emplace_back(1 - (u + v) / parts, u / parts, v / parts); };
    for (int i = 0; i < parts; ++i) {
      // There and back, so that each is next to the one before.
      const int row = parts - i;
      for (int k = 0; k < 2 * row - 1; ++k) {
        const int j = i % 2 == 0 ? k : 2 * row - 2 - k, column = j / 2;
        const double third = j % 2 == 0 ? 1.0 / 3 : 2.0 / 3;
        add(column + third, i + third);
      }
    }
    return weights;
  }

  template <typename Work>
  void for_each(std::size_t n, const Work& work) {
    for_blocks(context_, n, kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) work(static_cast<std::uint32_t>(i));
    });
  }

  /// What each triangle's places ask of its corners: pull_ along their normals, corner_ and side_ the matrix of it.
  void look() {
    corner_.assign(mesh_.twins.size(), {});
    side_.assign(mesh_.twins.size(), {});
    pull_.assign(mesh_.twins.size(), Vec3f::Zero());
    deviation_.assign(mesh_.face_count(), 0);
    for_each(mesh_.face_count(), [&](std::uint32_t f) {
      const Triangle& t = mesh_.triangles[f];
      const Vec3d corners[] = {mesh_.positions[t[0]], mesh_.positions[t[1]], mesh_.positions[t[2]]};
      const Vec3d facing = area_vector(mesh_, f).normalized();
      const double weight = triangle_area(mesh_, f) / mean_area_ / static_cast<double>(weights_.size());
      std::uint32_t face = foot_[f];
      for (std::size_t i = 0; i < weights_.size(); ++i) {
        const Vec3d& b = weights_[i];
        const Vec3d p = b[0] * corners[0] + b[1] * corners[1] + b[2] * corners[2];
        const WalkPlace foot = surface_.nearest(face, p);
        face = foot.face;
        if (i == 0) foot_[f] = face;
        const Vec3d normal = surface_.normal(face);
        const double distance = normal.dot(foot.position - p);
        deviation_[f] += weight * facing.cross(normal).squaredNorm();
        for (std::uint32_t c = 0; c < 3; ++c) {
          const std::uint32_t h = 3 * f + c;
          pull_[h] += (weight * b[c] * distance * normal).cast<float>();
          corner_[h].add(normal, weight * b[c] * b[c]);
          side_[h].add(normal, weight * b[c] * b[(c + 1) % 3]);
        }
      }
    });
  }

  /// Adds up what the triangles ask around vertices and across edges.
  void gather() {
    for_each(mesh_.twins.size(), [&](std::uint32_t h) {
      const std::uint32_t twin = mesh_.twins[h];
      if (twin == kNone || twin < h) return;
      side_[h].add(side_[twin]);
      side_[twin] = side_[h];
    });
    const std::size_t n = mesh_.vertex_count();
    const double sum_of_deviation = std::accumulate(deviation_.begin(), deviation_.end(), 0.0);
    const double deviation = std::max(kLeastDeviation, sum_of_deviation / static_cast<double>(mesh_.face_count()));
    matrix_.assign(n, {});
    right_.assign(n, Vec3d::Zero());
    inverse_.assign(n, Eigen::Matrix3d::Zero());
    for_each(n, [&](std::uint32_t v) {
      if (stays_[v]) return;
      Symmetric sum;
      Vec3d pull = Vec3d::Zero();
      mesh_.for_each_outgoing(v, [&](std::uint32_t h) {
        sum.add(corner_[h]);
        pull += pull_[h].cast<double>();
      });
      const double hold = kHold * deviation * static_cast<double>(sum.m[0] + sum.m[3] + sum.m[5]);
      for (const int i : {0, 3, 5}) sum.m[static_cast<std::size_t>(i)] += static_cast<float>(hold);
      if (!(hold > 0)) return;
      matrix_[v] = sum;
      right_[v] = pull + hold * (start_[v] - mesh_.positions[v]);
      inverse_[v] = sum.full().inverse();
    });
  }

  /// The matrix times a step of every vertex; 0 where vertices stay.
  Vec3d times(std::uint32_t v, const std::vector<Vec3d>& step) const {
    if (stays_[v]) return Vec3d::Zero();
    Vec3d sum = matrix_[v].times(step[v]);
    mesh_.for_each_outgoing(v, [&](std::uint32_t h) { sum += side_[h].times(step[mesh_.to(h)]); });
    return sum;
  }

  /// The same for any number of threads: block by block, then these.
  double dot(const std::vector<Vec3d>& a, const std::vector<Vec3d>& b) {
    sums_.assign((a.size() + kGrain - 1) / kGrain, 0);
    for_blocks(context_, a.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      double sum = 0;
      for (std::size_t i = begin; i < end; ++i) sum += a[i].dot(b[i]);
      sums_[begin / kGrain] = sum;
    });
    double sum = 0;
    for (const double part : sums_) sum += part;
    return sum;
  }

  /// Conjugate gradients, preconditioned by what each vertex would do alone.
  void solve() {
    const std::size_t n = mesh_.vertex_count();
    step_.assign(n, Vec3d::Zero());
    std::vector<Vec3d> rest = right_, towards(n), direction(n), image(n);
    const auto precondition = [&] { for_each(n, [&](std::uint32_t v) { towards[v] = inverse_[v] * rest[v]; }); };
    precondition();
    direction = towards;
    double square = dot(rest, towards);
    const double enough = kEnough * kEnough * square;
    for (int i = 0; i < kMostSteps && square > enough && !context_.cancelled(); ++i) {
      for_each(n, [&](std::uint32_t v) { image[v] = times(v, direction); });
      const double along = square / dot(direction, image);
      for_each(n, [&](std::uint32_t v) {
        step_[v] += along * direction[v];
        rest[v] -= along * image[v];
      });
      precondition();
      const double next = dot(rest, towards), turn = next / square;
      square = next;
      for_each(n, [&](std::uint32_t v) { direction[v] = towards[v] + turn * direction[v]; });
    }
  }

  /// Goes the steps, none farther than half the shortest edge around.
  void move() {
    std::vector<Vec3d> after = mesh_.positions;
    for_each(mesh_.vertex_count(), [&](std::uint32_t v) {
      if (stays_[v]) return;
      double room = std::numeric_limits<double>::infinity();
      mesh_.for_each_outgoing(
          v, [&](std::uint32_t h) { room = std::min(room, 0.5 * (mesh_.positions[mesh_.to(h)] - mesh_.positions[v]).norm()); });
      const double length = step_[v].norm();
      if (std::isfinite(length)) after[v] += length > room ? Vec3d(room / length * step_[v]) : step_[v];
    });
    unfold(mesh_.triangles, mesh_.positions, after, {.least_angle = kLeastAngle, .halvings = kHalvings});
    mesh_.positions = std::move(after);
  }

  HalfedgeMesh& mesh_;
  const SurfaceWalk& surface_;
  const ExecutionContext& context_;
  std::vector<bool> stays_;               // per vertex: on a border or a feature
  const std::vector<Vec3d> start_;        // of vertices
  const std::vector<Vec3d> weights_;      // of the corners, for each place in a triangle
  const double mean_area_;                // of triangles
  std::vector<std::uint32_t> foot_;       // of each triangle's first place: a face of the surface
  std::vector<Symmetric> corner_, side_;  // per halfedge: of its first corner, between its two
  std::vector<Vec3f> pull_;               // per halfedge: on its first corner
  std::vector<double> deviation_;         // per triangle: what kHold is times, weighted by area
  std::vector<Symmetric> matrix_;         // per vertex
  std::vector<Vec3d> right_, step_;
  std::vector<Eigen::Matrix3d> inverse_;
  std::vector<double> sums_;
};

}  // namespace

void fit(HalfedgeMesh& mesh, const SurfaceWalk& surface, std::span<const WalkPlace> places, const ExecutionContext& context) {
  Fitter(mesh, surface, places, context).run();
}

}  // namespace curvecast
