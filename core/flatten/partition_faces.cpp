#include "core/flatten/partition_faces.h"

#include <tbb/parallel_for.h>
#include <tbb/task_group.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "core/flatten/face_set.h"
#include "core/mesh/centroid.h"

namespace curvecast {
namespace {

constexpr std::size_t kSamples = 1 << 16;  // faces that show where to cut
constexpr std::size_t kBins = 128;         // places along the axis to choose from
// The smaller side of a cut has at least this part of what it should have.
constexpr double kLeastShare = 0.8;
// What a plane cuts off from its part stays a part by itself from this share of a part on.
constexpr std::size_t kFragmentShare = 4;

/// A plane; faces whose centroids lie below it are on its first side.
struct Plane {
  Vec3d normal;
  double offset;
};

/// Chooses the plane that cuts some faces into `share` and the rest, across their longest axis, where the cut is short.
Plane choose_plane(const TriangleMesh& mesh, std::span<const std::uint32_t> faces, double share) {
  const std::size_t step = std::max<std::size_t>(1, faces.size() / kSamples);
  std::vector<std::uint32_t> samples;
  for (std::size_t i = step / 2; i < faces.size(); i += step) samples.push_back(faces[i]);
  Vec3d mean = Vec3d::Zero();
  for (const std::uint32_t f : samples) mean += centroid(mesh, f);
  mean /= static_cast<double>(samples.size());
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  for (const std::uint32_t f : samples) {
    const Vec3d from_mean = centroid(mesh, f) - mean;
    inertia += from_mean * from_mean.transpose();
  }
  const Vec3d axis = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(inertia).eigenvectors().col(2);
  std::vector<std::pair<double, std::uint32_t>> along;
  for (const std::uint32_t f : samples) along.emplace_back(axis.dot(centroid(mesh, f)), f);
  std::sort(along.begin(), along.end());
  // Between these the cut may lie. How long it is there on average says the coarea formula: the integral of its length over the
  // offset is that of the slope along the surface over the area.
  const auto at = [&](double part) {
    return std::min(static_cast<std::size_t>(part * static_cast<double>(along.size())), along.size() - 1);
  };
  const double slack = (1 - kLeastShare) * std::min(share, 1 - share);
  const std::size_t begin = at(share - slack), end = at(share + slack);
  const double least = along[begin].first, width = (along[end].first - least) / kBins;
  if (!(width > 0)) return {axis, along[at(share)].first};
  std::array<double, kBins> length{};
  for (std::size_t i = begin; i <= end; ++i) {
    const auto& [offset, f] = along[i];
    const Triangle& t = mesh.triangles[f];
    const Vec3d normal = (mesh.positions[t[1]] - mesh.positions[t[0]]).cross(mesh.positions[t[2]] - mesh.positions[t[0]]);
    length[std::min(static_cast<std::size_t>((offset - least) / width), kBins - 1)] += axis.cross(normal).norm();
  }
  // A few bins together, since samples are few; the one in the middle of the range where several are as good.
  constexpr std::size_t kAround = 4;
  std::size_t best = kBins / 2;
  double shortest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < kBins; ++k) {
    const std::size_t b = k % 2 == 0 ? kBins / 2 + k / 2 : kBins / 2 - (k + 1) / 2;
    double sum = 0;
    for (std::size_t i = b < kAround ? 0 : b - kAround; i < std::min(b + kAround + 1, kBins); ++i) sum += length[i];
    sum /= static_cast<double>(std::min(b + kAround + 1, kBins) - (b < kAround ? 0 : b - kAround));
    if (sum < 0.95 * shortest) shortest = sum, best = b;
  }
  return {axis, least + (static_cast<double>(best) + 0.5) * width};
}

/// Halves faces again and again. The parts are ranges of `faces`, which is reordered.
class Bisection {
 public:
  Bisection(const TriangleMesh& mesh, std::span<std::uint32_t> faces, const ExecutionContext& context)
      : mesh_(mesh), faces_(faces), context_(context), scratch_(faces.size()) {}

  /// Writes the ranges of `parts.size()` parts of the faces [begin, end). Cancelled, they are of no use.
  void divide(std::size_t begin, std::size_t end, std::span<std::span<std::uint32_t>> parts) {
    const std::span<std::uint32_t> faces = faces_.subspan(begin, end - begin);
    if (parts.size() == 1) {
      parts[0] = faces;
      return;
    }
    if (context_.cancelled()) return;
    const std::size_t first = parts.size() / 2;
    const Plane plane = choose_plane(mesh_, faces, static_cast<double>(first) / static_cast<double>(parts.size()));
    std::size_t middle = begin + sort_by_side(plane, faces, std::span(scratch_).subspan(begin, end - begin));
    // Where all lie at one place, any half will do.
    if (middle == begin || middle == end) middle = begin + (end - begin) / 2;
    tbb::task_group both;
    both.run([&] { divide(begin, middle, parts.first(first)); });
    divide(middle, end, parts.subspan(first));
    both.wait();
  }

 private:
  /// Brings the faces below a plane to the front; both sides stay in their order. Returns how many they are.
  std::size_t sort_by_side(const Plane& plane, std::span<std::uint32_t> faces, std::span<std::uint32_t> scratch) const {
    constexpr std::size_t kBlock = 1 << 15;
    const std::size_t blocks = (faces.size() + kBlock - 1) / kBlock;
    const auto block = [&](std::size_t b) { return faces.subspan(b * kBlock, std::min(kBlock, faces.size() - b * kBlock)); };
    std::vector<std::size_t> below(blocks + 1, 0);  // in the blocks before
    tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t b) {
      const std::span<std::uint32_t> own = block(b);
      const auto rest = std::stable_partition(
          own.begin(), own.end(), [&](std::uint32_t f) { return plane.normal.dot(centroid(mesh_, f)) < plane.offset; });
      below[b + 1] = static_cast<std::size_t>(rest - own.begin());
    });
    std::partial_sum(below.begin(), below.end(), below.begin());
    tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t b) {
      const std::size_t here = below[b + 1] - below[b];
      std::ranges::copy(block(b).first(here), scratch.begin() + static_cast<std::ptrdiff_t>(below[b]));
      std::ranges::copy(block(b).subspan(here),
                        scratch.begin() + static_cast<std::ptrdiff_t>(below[blocks] + b * kBlock - below[b]));
    });
    tbb::parallel_for(std::size_t{0}, blocks,
                      [&](std::size_t b) { std::ranges::copy(scratch.subspan(b * kBlock, block(b).size()), block(b).begin()); });
    return below[blocks];
  }

  const TriangleMesh& mesh_;
  const std::span<std::uint32_t> faces_;
  const ExecutionContext& context_;
  std::vector<std::uint32_t> scratch_;
};

/// Connected faces of one range.
struct Fragment {
  std::size_t range;
  std::size_t begin, size;  // of its faces in that range, which has been reordered
  std::uint32_t part = kNone;
};

/// The parts of a piece, while borders are smoothed and fragments joined.
class Joining {
 public:
  /// `ranges`: what the bisection made of `faces`.
  Joining(const TriangleMesh& mesh, std::span<const std::uint32_t> faces, std::span<const std::span<std::uint32_t>> ranges)
      : mesh_(mesh), set_(faces, mesh), range_of_(faces.size()), fragment_of_(faces.size(), kNone), ranges_(ranges.size()) {
    tbb::parallel_for(std::size_t{0}, ranges.size(), [&](std::size_t r) {
      for (const std::uint32_t f : ranges[r]) range_of_[set_.index(f)] = static_cast<std::uint32_t>(r);
    });
    smooth(faces);
    for (std::size_t r = 0; r < ranges.size(); ++r) ranges_[r].reserve(ranges[r].size());
    for (std::size_t i = 0; i < faces.size(); ++i) ranges_[range_of_[i]].push_back(faces[i]);
    std::vector<std::vector<Fragment>> found(ranges_.size());
    tbb::parallel_for(std::size_t{0}, ranges_.size(), [&](std::size_t r) { found[r] = fragments_of(r); });
    for (const std::vector<Fragment>& some : found) {
      first_.push_back(static_cast<std::uint32_t>(fragments_.size()));
      fragments_.insert(fragments_.end(), some.begin(), some.end());
    }
  }

  /// Makes the largest fragment of each range a part, and gives the small ones to the neighbour with the longest common border.
  std::vector<std::vector<std::uint32_t>> join() {
    std::vector<std::uint32_t> small;
    std::uint32_t parts = 0;
    for (std::size_t r = 0; r < ranges_.size(); ++r) {
      const std::size_t end = r + 1 < first_.size() ? first_[r + 1] : fragments_.size();
      std::uint32_t largest = first_[r];
      for (std::uint32_t i = first_[r]; i < end; ++i) {
        if (fragments_[i].size > fragments_[largest].size) largest = i;
      }
      for (std::uint32_t i = first_[r]; i < end; ++i) {
        if (i == largest || fragments_[i].size * kFragmentShare * ranges_.size() > range_of_.size()) {
          fragments_[i].part = parts++;
        } else {
          small.push_back(i);
        }
      }
    }
    while (!small.empty()) {
      const std::size_t before = small.size();
      std::erase_if(small, [&](std::uint32_t i) { return (fragments_[i].part = neighbour_of(i)) != kNone; });
      if (small.size() == before) break;  // not connected: cannot be, by the precondition
    }
    std::vector<std::vector<std::uint32_t>> faces(parts);
    for (const Fragment& fragment : fragments_) {
      if (fragment.part == kNone) continue;
      const std::span<const std::uint32_t> own = faces_of(fragment);
      faces[fragment.part].insert(faces[fragment.part].end(), own.begin(), own.end());
    }
    tbb::parallel_for(std::size_t{0}, faces.size(), [&](std::size_t p) { std::sort(faces[p].begin(), faces[p].end()); });
    return faces;
  }

  /// The part of the face beyond halfedge h; kNone where there is none, or not of the piece.
  std::uint32_t part_beyond(std::uint32_t h) const {
    const std::uint32_t twin = mesh_.twins[h], i = twin == kNone ? kNone : set_.index(twin / 3);
    return i == kNone ? kNone : fragments_[first_[range_of_[i]] + fragment_of_[i]].part;
  }

 private:
  std::span<const std::uint32_t> faces_of(const Fragment& fragment) const {
    return std::span(ranges_[fragment.range]).subspan(fragment.begin, fragment.size);
  }

  /// The ranges of a face's neighbours, kNone where there is none.
  std::array<std::uint32_t, 3> ranges_around(std::uint32_t f, std::uint32_t number) const {
    std::array<std::uint32_t, 3> around;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t twin = mesh_.twins[3 * f + k], next = twin == kNone ? kNone : set_.index(twin / 3, number);
      around[k] = next == kNone ? kNone : range_of_[next];
    }
    return around;
  }

  /// Gives faces with two sides on the border of another range to that one: borders without teeth, which would be squeezed flat
  /// on a side of the square.
  void smooth(std::span<const std::uint32_t> faces) {
    constexpr std::size_t kBlock = 1 << 16;
    std::vector<std::vector<std::uint32_t>> found(faces.size() / kBlock + 1);  // the numbers of faces beside other ranges
    tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t block) {
      for (std::size_t i = block * kBlock; i < std::min((block + 1) * kBlock, faces.size()); ++i) {
        for (const std::uint32_t range : ranges_around(faces[i], static_cast<std::uint32_t>(i))) {
          if (range == kNone || range == range_of_[i]) continue;
          found[block].push_back(static_cast<std::uint32_t>(i));
          break;
        }
      }
    });
    constexpr int kSweeps = 4;
    bool any = true;
    for (int sweep = 0; any && sweep < kSweeps; ++sweep) {
      any = false;
      for (const std::vector<std::uint32_t>& some : found) {
        for (const std::uint32_t i : some) {
          const auto [a, b, c] = ranges_around(faces[i], i);
          const std::uint32_t most = a == b || a == c ? a : b == c ? b : kNone;
          if (most == kNone || most == range_of_[i]) continue;
          range_of_[i] = most;
          any = true;
        }
      }
    }
  }

  /// Reorders a range by connected fragments, and numbers these.
  std::vector<Fragment> fragments_of(std::size_t r) {
    std::vector<Fragment> fragments;
    std::vector<std::uint32_t> ordered;
    ordered.reserve(ranges_[r].size());
    for (const std::uint32_t seed : ranges_[r]) {
      if (fragment_of_[set_.index(seed)] != kNone) continue;
      const auto number = static_cast<std::uint32_t>(fragments.size());
      const std::size_t begin = ordered.size();
      fragment_of_[set_.index(seed)] = number;
      ordered.push_back(seed);
      for (std::size_t i = begin; i < ordered.size(); ++i) {
        for (std::uint32_t h = 3 * ordered[i]; h < 3 * ordered[i] + 3; ++h) {
          const std::uint32_t twin = mesh_.twins[h], next = twin == kNone ? kNone : set_.index(twin / 3);
          if (next == kNone || range_of_[next] != r || fragment_of_[next] != kNone) continue;
          fragment_of_[next] = number;
          ordered.push_back(twin / 3);
        }
      }
      fragments.push_back({r, begin, ordered.size() - begin});
    }
    ranges_[r] = std::move(ordered);
    return fragments;
  }

  /// The part with which a fragment has most edges in common; kNone where no neighbour is of a part yet.
  std::uint32_t neighbour_of(std::uint32_t i) const {
    std::map<std::uint32_t, std::size_t> edges;
    for (const std::uint32_t f : faces_of(fragments_[i])) {
      for (std::uint32_t h = 3 * f; h < 3 * f + 3; ++h) {
        const std::uint32_t part = part_beyond(h);
        if (part != kNone) ++edges[part];
      }
    }
    const auto most =
        std::max_element(edges.begin(), edges.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    return most == edges.end() ? kNone : most->first;
  }

  const TriangleMesh& mesh_;
  const FaceSet set_;
  std::vector<std::uint32_t> range_of_;             // of each face of the piece
  std::vector<std::uint32_t> fragment_of_;          // of its range
  std::vector<std::vector<std::uint32_t>> ranges_;  // their faces, fragment by fragment
  std::vector<Fragment> fragments_;                 // range by range
  std::vector<std::uint32_t> first_;                // of each range
};

/// The common border of two parts.
struct Gate {
  Vec3d sum = Vec3d::Zero();  // of the middles of its edges
  std::size_t edges = 0;
};
using Gates = std::vector<std::map<std::uint32_t, Gate>>;  // of each part, by neighbour

/// An order of the parts in which few follow one that is not their neighbour, nor is near.
std::vector<std::uint32_t> find_way(const std::vector<Vec3d>& middles, const Gates& gates) {
  std::vector<std::uint32_t> way(middles.size());
  std::iota(way.begin(), way.end(), 0u);
  constexpr std::size_t kMost = 4096;  // whose distances there is memory for
  if (way.size() > kMost) return way;
  constexpr double kNoNeighbour = 3;  // how much longer a step counts that leaves the surface
  std::vector<float> costs(way.size() * way.size());
  tbb::parallel_for(std::size_t{0}, way.size(), [&](std::size_t a) {
    for (std::uint32_t b = 0; b < way.size(); ++b) {
      const double away = (middles[a] - middles[b]).norm() * (gates[a].contains(b) ? 1 : kNoNeighbour);
      costs[a * way.size() + b] = static_cast<float>(away);
    }
  });
  const auto cost = [&](std::uint32_t a, std::uint32_t b) { return costs[a * way.size() + b]; };
  // Parts come along the bisection's tree. Turning stretches of the way around shortens it (2-opt).
  constexpr int kMostSweeps = 100;
  constexpr float kLeastGain = 1e-3f;
  bool is_better = way.size() > 2;
  for (int sweep = 0; is_better && sweep < kMostSweeps; ++sweep) {
    is_better = false;
    for (std::size_t i = 0; i < way.size(); ++i) {
      for (std::size_t j = i + 1; j < way.size(); ++j) {
        float change = 0;
        if (i > 0) change += cost(way[i - 1], way[j]) - cost(way[i - 1], way[i]);
        if (j + 1 < way.size()) change += cost(way[i], way[j + 1]) - cost(way[j], way[j + 1]);
        if (!(change < -kLeastGain * cost(way[i], way[j]))) continue;
        std::reverse(way.begin() + static_cast<std::ptrdiff_t>(i), way.begin() + static_cast<std::ptrdiff_t>(j + 1));
        is_better = true;
      }
    }
  }
  return way;
}

}  // namespace

std::vector<FacePart> partition_faces(const TriangleMesh& mesh, std::span<const std::uint32_t> faces, std::size_t count,
                                      const ExecutionContext& context) {
  count = std::clamp<std::size_t>(count, 1, faces.size());
  std::vector<std::uint32_t> order(faces.begin(), faces.end());
  std::vector<std::span<std::uint32_t>> ranges(count);
  Bisection(mesh, order, context).divide(0, order.size(), ranges);
  if (context.cancelled()) return {};
  Joining joining(mesh, faces, ranges);
  if (context.cancelled()) return {};
  std::vector<std::vector<std::uint32_t>> parts = joining.join();
  if (context.cancelled()) return {};
  Gates gates(parts.size());
  std::vector<Vec3d> middles(parts.size(), Vec3d::Zero());
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t p) {
    for (const std::uint32_t f : parts[p]) {
      middles[p] += centroid(mesh, f);
      for (std::uint32_t h = 3 * f; h < 3 * f + 3; ++h) {
        const std::uint32_t other = joining.part_beyond(h);
        if (other == kNone || other == p) continue;
        Gate& gate = gates[p][other];
        gate.sum += 0.5 * (mesh.positions[mesh.from(h)] + mesh.positions[mesh.to(h)]);
        ++gate.edges;
      }
    }
    middles[p] /= static_cast<double>(parts[p].size());
  });
  const std::vector<std::uint32_t> way = find_way(middles, gates);
  std::vector<FacePart> divided(way.size());
  for (std::size_t i = 0; i < way.size(); ++i) {
    divided[i].faces = std::move(parts[way[i]]);
    if (i == 0) continue;
    const auto found = gates[way[i]].find(way[i - 1]);
    divided[i].entry = divided[i - 1].exit = found != gates[way[i]].end()
                                                 ? Vec3d(found->second.sum / static_cast<double>(found->second.edges))
                                                 : Vec3d(0.5 * (middles[way[i]] + middles[way[i - 1]]));
  }
  return divided;
}

}  // namespace curvecast
