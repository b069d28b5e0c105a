#include "core/remesh/valence_flips.h"

#include <algorithm>
#include <vector>

namespace curvecast {
namespace {

constexpr double kLeastCosine = -0.5;
constexpr int kMostRounds = 4;

class ValenceFlips {
 public:
  explicit ValenceFlips(HalfedgeMesh& mesh) : mesh_(mesh), surplus_(mesh.vertex_count(), 0) {
    for (std::uint32_t v = 0; v < surplus_.size(); ++v) {
      if (!mesh.has_vertex(v)) continue;
      surplus_[v] = mesh.on_border(v) ? -4 : -6;
      mesh.for_each_neighbour(v, [&](std::uint32_t) { ++surplus_[v]; });
    }
  }

  /// Looks at every edge once. Returns whether any was turned.
  bool run() {
    bool any = false;
    for (std::uint32_t h = 0; h < mesh_.twins.size(); ++h) {
      const std::uint32_t t = mesh_.twins[h];
      if (!mesh_.has_face(h / 3) || t == kNone || t < h || !gains(h) || !is_sound(h) || !mesh_.may_flip(h)) continue;
      --surplus_[mesh_.from(h)], --surplus_[mesh_.to(h)];
      ++surplus_[mesh_.apex(h)], ++surplus_[mesh_.apex(t)];
      mesh_.flip(h);
      any = true;
    }
    return any;
  }

 private:
  bool gains(std::uint32_t h) const {
    const int a = surplus_[mesh_.from(h)], b = surplus_[mesh_.to(h)];
    const int c = surplus_[mesh_.apex(h)], d = surplus_[mesh_.apex(mesh_.twins[h])];
    return c + d + 2 < a + b;  // half of the difference of the squares
  }

  bool is_sound(std::uint32_t h) const {
    const Vec3d &a = mesh_.positions[mesh_.from(h)], &b = mesh_.positions[mesh_.to(h)];
    const Vec3d &c = mesh_.positions[mesh_.apex(h)], &d = mesh_.positions[mesh_.apex(mesh_.twins[h])];
    const Vec3d before = (b - a).cross(c - a) + (a - b).cross(d - b);
    const auto is_good = [&](const Vec3d& p, const Vec3d& q, const Vec3d& r) {
      if (!((q - p).cross(r - p).dot(before) > 0)) return false;
      const auto cosine = [](const Vec3d& at, const Vec3d& x, const Vec3d& y) {
        return (x - at).dot(y - at) / ((x - at).norm() * (y - at).norm());
      };
      return std::min({cosine(p, q, r), cosine(q, r, p), cosine(r, p, q)}) > kLeastCosine;
    };
    return is_good(d, c, a) && is_good(c, d, b);
  }

  HalfedgeMesh& mesh_;
  std::vector<int> surplus_;  // of neighbours, of each vertex
};

}  // namespace

void flip_to_valence(HalfedgeMesh& mesh) {
  ValenceFlips flips(mesh);
  for (int round = 0; round < kMostRounds && flips.run(); ++round) {
  }
}

}  // namespace curvecast
