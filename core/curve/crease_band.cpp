#include "core/curve/crease_band.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <nanoflann.hpp>
#include <vector>

#include "core/base/for_all.h"

namespace curvecast {
namespace {

constexpr float kSharp = 0.94F;  // cosine: sides that differ by less stick out of each other by too little to be seen
constexpr float kSameSide = 0.8F;
constexpr double kSamplesInBand = 2;      // of an edge, in the band's width
constexpr double kMostSamples = 500'000;  // of all edges together, but one at least of each
constexpr std::size_t kLeaf = 16;
constexpr std::size_t kFew =
    32;  // places near a block of vertices, each of which is compared with all of them rather than search a tree
constexpr std::size_t kGrain = 1024;

/// A place on a crease.
struct CreasePlace {
  Vec3f position;  // relative to the curve's origin
  std::array<Vec3f, 2> normals;
};

/// An edge of a face that has normals of its own.
struct CreaseEdge {
  std::uint32_t low, high;       // vertices
  std::array<Vec3f, 2> normals;  // on the face's side, at `low` and `high`

  bool is_of(const CreaseEdge& other) const { return low == other.low && high == other.high; }
};

std::vector<CreaseEdge> edges_of_creases(const SurfaceData& data) {
  std::vector<CreaseEdge> edges;
  edges.reserve(3 * data.creases.faces.size());
  for (const CreaseFace& crease : data.creases.faces) {
    const Triangle& corners = data.mesh.triangles[crease.face];
    for (std::size_t i = 0; i < 3; ++i) {
      std::size_t a = i, b = (i + 1) % 3;
      if (corners[a] > corners[b]) std::swap(a, b);
      edges.push_back(
          {corners[a], corners[b], {data.corner_normal(crease.face, a, &crease), data.corner_normal(crease.face, b, &crease)}});
    }
  }
  // Of one edge in the order of their faces.
  std::stable_sort(edges.begin(), edges.end(),
                   [](const CreaseEdge& a, const CreaseEdge& b) { return a.low != b.low ? a.low < b.low : a.high < b.high; });
  return edges;
}

/// Calls visit(edge, normals on the other side) for the edges at which the sides differ.
template <typename Visit>
void for_each_crease(const SurfaceData& data, std::span<const CreaseEdge> edges, const Visit& visit) {
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const CreaseEdge& edge = edges[i];
    if (i > 0 && edge.is_of(edges[i - 1])) continue;
    std::array<Vec3f, 2> others = {data.geometry[edge.low].normal, data.geometry[edge.high].normal};
    if (i + 1 < edges.size() && edge.is_of(edges[i + 1])) others = edges[i + 1].normals;
    if (std::min(edge.normals[0].dot(others[0]), edge.normals[1].dot(others[1])) < kSharp) visit(edge, others);
  }
}

std::vector<CreasePlace> places_on_creases(const SurfaceData& data, const Vec3d& origin, double reach) {
  const std::vector<CreaseEdge> edges = edges_of_creases(data);
  const auto length = [&](const CreaseEdge& edge) {
    return (data.mesh.positions[edge.high] - data.mesh.positions[edge.low]).norm();
  };
  double total = 0;
  for_each_crease(data, edges, [&](const CreaseEdge& edge, const std::array<Vec3f, 2>&) { total += length(edge); });
  const double step = std::max(reach / kSamplesInBand, total / kMostSamples);
  std::vector<CreasePlace> places;
  for_each_crease(data, edges, [&](const CreaseEdge& edge, const std::array<Vec3f, 2>& others) {
    const Vec3d low = data.mesh.positions[edge.low] - origin, high = data.mesh.positions[edge.high] - origin;
    const auto count = static_cast<std::size_t>(std::max(1.0, std::ceil(length(edge) / step)));
    for (std::size_t k = 0; k < count; ++k) {
      const double t = (static_cast<double>(k) + 0.5) / static_cast<double>(count);
      const auto mixed = [t](const std::array<Vec3f, 2>& ends) {
        return Vec3f(((1 - t) * ends[0].cast<double>() + t * ends[1].cast<double>()).cast<float>().normalized());
      };
      places.push_back({((1 - t) * low + t * high).cast<float>(), {mixed(edge.normals), mixed(others)}});
    }
  });
  return places;
}

struct Positions {
  std::span<const CreasePlace> places;

  std::size_t kdtree_get_point_count() const { return places.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const { return places[i].position[static_cast<Eigen::Index>(axis)]; }
  template <class Box>
  bool kdtree_get_bbox(Box& /*box*/) const {
    return false;
  }
};
using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Positions>, Positions, 3, std::uint32_t>;

/// Finds the nearest place that is nearer than a reach.
class Nearest {
 public:
  using DistanceType = float;
  using IndexType = std::uint32_t;

  explicit Nearest(float reach) : square_(reach * reach) {}
  std::size_t size() const { return place_ == kNone ? 0 : 1; }
  bool full() const { return true; }
  float worstDist() const { return square_; }
  bool addPoint(float square, std::uint32_t place) {
    if (square < square_) square_ = square, place_ = place;
    return true;
  }
  bool is_there() const { return place_ != kNone; }
  std::uint32_t place() const { return place_; }

 private:
  float square_;
  std::uint32_t place_ = kNone;
};

/// Collects the places that are nearer than a reach, until they are more than kFew.
class Few {
 public:
  using DistanceType = float;
  using IndexType = std::uint32_t;

  explicit Few(float reach) : square_(reach * reach) {}
  std::size_t size() const { return size_; }
  bool full() const { return true; }
  float worstDist() const { return square_; }
  bool addPoint(float /*square*/, std::uint32_t place) {
    if (size_ < kFew) places_[size_] = place;
    return ++size_ <= kFew;
  }
  bool are_too_many() const { return size_ > kFew; }
  std::span<const std::uint32_t> places() const { return {places_.data(), size_}; }

 private:
  std::array<std::uint32_t, kFew> places_;
  std::size_t size_ = 0;
  float square_;
};

template <typename Found>
Found find(const Tree& tree, const Vec3f& position, float reach) {
  Found found(reach);
  tree.findNeighbors(found, position.data(), nanoflann::SearchParams());
  return found;
}

/// What the surface faces beyond a place's crease, seen from where it faces `own`; zero from somewhere else.
Vec3f beyond(const CreasePlace& place, const Vec3f& own) {
  const float first = own.dot(place.normals[0]), second = own.dot(place.normals[1]);
  if (std::max(first, second) < kSameSide) return Vec3f::Zero();
  return place.normals[first > second ? 1 : 0];
}

}  // namespace

void fill_crease_band(const SurfaceData& data, SurfaceCurve& curve, const ExecutionContext& context) {
  curve.beside.resize(0);
  if (data.creases.faces.size() > kMostCreaseFaces) return;
  const double reach = kCreaseBand * curve.box.diagonal();
  const std::vector<CreasePlace> places = places_on_creases(data, curve.origin, reach);
  if (places.empty()) return;
  const Positions positions{places};
  const Tree tree(3, positions, nanoflann::KDTreeSingleIndexAdaptorParams(kLeaf));
  curve.beside.resize(curve.size());
  std::atomic<bool> is_any = false;
  const auto band = static_cast<float>(reach);
  for_blocks(context, block_count(curve.size()), kGrain / kBlockSize, [&](std::size_t first, std::size_t last) {
    bool has_one = false;
    for (std::size_t b = first; b < last; ++b) {
      const std::size_t begin = b * kBlockSize, end = std::min(begin + kBlockSize, curve.size());
      float radius = 0;
      for (std::size_t l = begin; l < end; ++l) radius = std::max(radius, (curve.position(l) - curve.position(begin)).norm());
      std::fill(curve.beside.begin() + begin, curve.beside.begin() + end, Direction8{});
      const Few few = find<Few>(tree, curve.position(begin), band + 1.01F * radius);
      if (few.size() == 0) continue;
      for (std::size_t l = begin; l < end; ++l) {
        Nearest found(band);
        if (few.are_too_many()) {
          found = find<Nearest>(tree, curve.position(l), band);
        } else {
          for (const std::uint32_t p : few.places()) found.addPoint((places[p].position - curve.position(l)).squaredNorm(), p);
        }
        if (found.is_there()) curve.beside[l] = Direction8(beyond(places[found.place()], curve.normal(l)));
        has_one = has_one || !curve.beside[l].is_none();
      }
    }
    if (has_one) is_any = true;
  });
  if (!is_any) curve.beside.resize(0);
}

Direction8 beside_within(const SurfaceCurve& curve, std::size_t l, const Vec3f& normal) {
  const Direction8 beside = curve.beside[l];
  if (beside.is_none() || normal.dot(beside.unpacked<Vec3f>()) <= normal.dot(curve.normal(l))) return beside;
  return Direction8(curve.normal(l));
}

}  // namespace curvecast
