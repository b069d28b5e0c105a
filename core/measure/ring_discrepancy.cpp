#include "core/measure/ring_discrepancy.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>

#include "core/base/random.h"

namespace curvecast {
namespace {

/// Which triangles meet at each vertex.
struct VertexFaces {
  std::vector<std::uint32_t> begin;  // V + 1 offsets into `faces`
  std::vector<std::uint32_t> faces;

  explicit VertexFaces(const TriangleMesh& mesh) : begin(mesh.vertex_count() + 1), faces(3 * mesh.face_count()) {
    for (const Triangle& t : mesh.triangles) {
      for (const std::uint32_t v : t) ++begin[v + 1];
    }
    for (std::size_t v = 1; v < begin.size(); ++v) begin[v] += begin[v - 1];
    std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
      for (const std::uint32_t v : mesh.triangles[f]) faces[next[v]++] = f;
    }
  }
};

/// Grows regions over one mesh; each thread has its own.
class Grower {
 public:
  Grower(const TriangleMesh& mesh, const VertexFaces& faces_of)
      : mesh_(mesh), faces_of_(faces_of), face_seen_(mesh.face_count()), vertex_seen_(mesh.vertex_count()) {}

  /// Calls add(face) for each face of the seed's component, ring by ring, and end_ring() after each ring.
  template <typename Add, typename EndRing>
  void grow(std::uint32_t seed, Add&& add, EndRing&& end_ring) {
    ++stamp_;
    front_.clear();
    take(seed, front_, add);
    for (;;) {
      end_ring();
      next_.clear();
      bool has_grown = false;
      for (const std::uint32_t v : front_) {
        for (std::uint32_t i = faces_of_.begin[v]; i < faces_of_.begin[v + 1]; ++i) {
          const std::uint32_t f = faces_of_.faces[i];
          if (face_seen_[f] == stamp_) continue;
          has_grown = true;
          take(f, next_, add);
        }
      }
      if (!has_grown) return;
      front_.swap(next_);
    }
  }

 private:
  template <typename Add>
  void take(std::uint32_t face, std::vector<std::uint32_t>& front, Add&& add) {
    face_seen_[face] = stamp_;
    add(face);
    for (const std::uint32_t v : mesh_.triangles[face]) {
      if (vertex_seen_[v] == stamp_) continue;
      vertex_seen_[v] = stamp_;
      front.push_back(v);
    }
  }

  const TriangleMesh& mesh_;
  const VertexFaces& faces_of_;
  std::vector<std::uint32_t> face_seen_, vertex_seen_;  // by the region with that number
  std::uint32_t stamp_ = 0;
  std::vector<std::uint32_t> front_, next_;
};

}  // namespace

std::vector<double> ring_set_sizes(std::uint64_t most) {
  std::vector<double> sizes;
  for (int l = 1; l <= 20; ++l) {
    for (const std::uint64_t n : {std::uint64_t{2} << (l - 1), std::uint64_t{3} << (l - 1)}) {
      if (n <= most) sizes.push_back(static_cast<double>(n));
    }
  }
  return sizes;
}

std::vector<Discrepancy> ring_discrepancy(const TriangleMesh& mesh, std::span<const std::vector<std::uint32_t>> sets,
                                          const RingDiscrepancyOptions& options, const ExecutionContext& context) {
  const std::size_t set_count = sets.size();
  const std::size_t faces = mesh.face_count();
  const auto regions = static_cast<std::size_t>(options.regions);
  // Of each face, for all sets side by side: a region asks for all of them at once.
  std::vector<std::uint32_t> counts(faces * set_count);
  for (std::size_t s = 0; s < set_count; ++s) {
    for (const std::uint32_t f : sets[s]) ++counts[f * set_count + s];
  }
  std::vector<double> mass(faces);
  double total = 0;
  for (std::size_t f = 0; f < faces; ++f) {
    mass[f] = triangle_area(mesh, f) * (options.face_density.empty() ? 1 : options.face_density[f]);
    total += mass[f];
  }

  const VertexFaces faces_of(mesh);
  std::vector<DiscrepancySum> found(regions * set_count);
  tbb::enumerable_thread_specific<Grower> growers([&] { return Grower(mesh, faces_of); });
  tbb::parallel_for(std::size_t{0}, regions, [&](std::size_t region) {
    if (context.cancelled()) return;
    DiscrepancySum* const own = &found[region * set_count];
    std::vector<std::uint32_t> inside(set_count);
    double inside_mass = 0;
    const auto add = [&](std::uint32_t f) {
      inside_mass += mass[f];
      const std::uint32_t* const row = &counts[f * set_count];
      for (std::size_t s = 0; s < set_count; ++s) inside[s] += row[s];
    };
    const auto end_ring = [&] {
      const double share = std::min(inside_mass / total, 1.0);
      for (std::size_t s = 0; s < set_count; ++s) {
        own[s].add(static_cast<double>(inside[s]) / static_cast<double>(sets[s].size()), share);
      }
    };
    const auto seed = static_cast<std::uint32_t>(random_unit(options.seed, region) * static_cast<double>(faces));
    growers.local().grow(seed, add, end_ring);
  });

  std::vector<DiscrepancySum> sums(set_count);
  for (std::size_t i = 0; i < found.size(); ++i) sums[i % set_count].add_mean(found[i]);
  std::vector<Discrepancy> result;
  for (std::size_t s = 0; s < set_count; ++s) result.push_back(sums[s].result(static_cast<double>(sets[s].size())));
  return result;
}

}  // namespace curvecast
