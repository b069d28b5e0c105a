#include "core/mesh/own_crease_angle.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include "core/base/random.h"
#include "core/mesh/crease_normals.h"

namespace curvecast {
namespace {

constexpr std::size_t kCorners = 1 << 14;    // about so many are looked at,
constexpr std::size_t kMost = 2 * kCorners;  // never more: files are read within bounds of memory
constexpr double kFlat = 1;                  // degrees: whether such an edge is split is not seen,
constexpr double kFlatQuantised = 2;         // ... nor is it where normals are rounded
constexpr double kMistaken = 0.02;           // of the edges of what is quantised
constexpr double kCoarse = 15;               // degrees between the faces of a mesh whose faces are meant to be seen
constexpr double kMargin = 0.05;             // degrees: angles are no more exact than floats make them

/// A polygon's edge, from a corner to the next one.
struct Side {
  std::uint64_t edge;  // hash of its places, the same from either end
  std::uint32_t polygon, corner;

  bool operator<(const Side& other) const { return std::pair(edge, corner) < std::pair(other.edge, other.corner); }
};

/// An edge between two faces.
struct Turn {
  double degrees;
  bool split;
};

std::uint64_t hash_of(const Vec3d& p) {
  std::uint64_t hash = 0;
  for (const double x : {p.x(), p.y(), p.z()})
    hash = mix_bits((hash ^ std::bit_cast<std::uint64_t>(x + 0.0)) + kRandomStep);  // -0 is 0
  return hash;
}

template <typename T>
double degrees_between(const Eigen::Matrix<T, 3, 1>& a, const Eigen::Matrix<T, 3, 1>& b) {
  return std::atan2(static_cast<double>(a.cross(b).norm()), static_cast<double>(a.dot(b))) * 180 / std::numbers::pi;
}

class OwnTurns {
 public:
  OwnTurns(const PolygonSoup& soup, const OwnShading& shading) : soup_(soup), shading_(shading) {}

  /// Of the edges that tell.
  std::vector<Turn> find() const {
    const std::vector<Side> sides = some_sides();
    const double flat = shading_.is_quantised ? kFlatQuantised : kFlat;
    std::vector<Turn> turns;
    for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
      for (end = i + 1; end < sides.size() && sides[end].edge == sides[i].edge;) ++end;
      if (end - i != 2) continue;  // of one face, or of three
      const Side &here = sides[i], &there = sides[i + 1];
      if (place(here.corner) == place(there.corner)) continue;  // its faces disagree
      const double degrees = degrees_between(face_normal(here.polygon), face_normal(there.polygon));
      if (!(degrees > flat)) continue;
      if (const std::optional<bool> split = is_split(here, there, degrees)) turns.push_back({degrees, *split});
    }
    return turns;
  }

 private:
  /// In order of edge. None where more than kMost are of the same few edges.
  std::vector<Side> some_sides() const {
    const std::uint64_t step = soup_.indices.size() / kCorners + 1;
    std::vector<Side> sides;
    sides.reserve(std::min(soup_.indices.size(), kMost));
    for (std::uint32_t p = 0; p < soup_.polygon_count(); ++p) {
      const std::uint32_t begin = soup_.polygon_begin[p], end = soup_.polygon_begin[p + 1];
      if (end - begin < 3) continue;
      const std::uint64_t first = hash_of(place(begin));
      std::uint64_t from = first;
      for (std::uint32_t corner = begin; corner < end; ++corner) {
        const std::uint64_t to = corner + 1 < end ? hash_of(place(corner + 1)) : first;
        const std::uint64_t edge = mix_bits(from + to + kRandomStep);
        from = to;
        if (edge % step != 0) continue;
        if (sides.size() == kMost) return {};
        sides.push_back({edge, p, corner});
      }
    }
    std::sort(sides.begin(), sides.end());
    return sides;
  }

  const Vec3d& place(std::uint32_t corner) const { return soup_.positions[soup_.indices[corner]]; }

  std::uint32_t next(const Side& side) const {
    return side.corner + 1 < soup_.polygon_begin[side.polygon + 1] ? side.corner + 1 : soup_.polygon_begin[side.polygon];
  }

  /// Of any length.
  Vec3d face_normal(std::uint32_t polygon) const {
    const std::uint32_t begin = soup_.polygon_begin[polygon];
    Vec3d normal = Vec3d::Zero();
    for (std::uint32_t i = begin + 2; i < soup_.polygon_begin[polygon + 1]; ++i) {
      normal += (place(i - 1) - place(begin)).cross(place(i) - place(begin));
    }
    return normal;
  }

  std::optional<Vec3f> normal_at(std::uint32_t corner) const {
    const std::uint32_t i = corner < shading_.normal_of_corner.size() ? shading_.normal_of_corner[corner] : kNone;
    if (i >= shading_.normals.size() || !(shading_.normals[i].squaredNorm() > 0)) return std::nullopt;
    return shading_.normals[i];
  }

  std::optional<bool> is_split(const Side& here, const Side& there, double degrees) const {
    const std::array<std::optional<Vec3f>, 4> normals = {normal_at(here.corner), normal_at(next(there)), normal_at(next(here)),
                                                         normal_at(there.corner)};
    if (std::all_of(normals.begin(), normals.end(), [](const auto& normal) { return normal.has_value(); })) {
      return degrees_between(*normals[0], *normals[1]) + degrees_between(*normals[2], *normals[3]) > degrees;
    }
    if (shading_.group_of_polygon.empty()) return std::nullopt;
    const std::uint32_t group = shading_.group_of_polygon[here.polygon];
    return group == 0 || group != shading_.group_of_polygon[there.polygon];
  }

  const PolygonSoup& soup_;
  const OwnShading& shading_;
};

/// What lies between the turns at which fewest edges are on the wrong side, as near to kCreaseDegrees as it can be.
double best_angle(const std::vector<Turn>& turns) {
  std::size_t wrong = static_cast<std::size_t>(std::count_if(turns.begin(), turns.end(), [](const Turn& t) { return !t.split; }));
  std::size_t fewest = wrong;
  double low = 0, high = turns.front().degrees;  // the angle lies between them
  for (std::size_t i = 0; i < turns.size(); ++i) {
    turns[i].split ? wrong += 1 : wrong -= 1;
    const double next = i + 1 < turns.size() ? turns[i + 1].degrees : 180;
    if (next == turns[i].degrees) continue;
    const auto distance = [](double from, double to) { return std::max({from - kCreaseDegrees, kCreaseDegrees - to, 0.0}); };
    if (wrong > fewest || (wrong == fewest && distance(low, high) <= distance(turns[i].degrees, next))) continue;
    fewest = wrong;
    low = turns[i].degrees;
    high = next;
  }
  return low + kMargin < kCreaseDegrees && kCreaseDegrees < high - kMargin ? kCreaseDegrees : (low + high) / 2;
}

}  // namespace

std::optional<double> own_crease_angle(const PolygonSoup& soup, const OwnShading& shading) {
  if (shading.normals.empty() && shading.group_of_polygon.empty()) return std::nullopt;
  std::vector<Turn> turns = OwnTurns(soup, shading).find();
  if (turns.empty()) return std::nullopt;
  std::sort(turns.begin(), turns.end(), [](const Turn& a, const Turn& b) { return a.degrees < b.degrees; });
  const auto split =
      static_cast<std::size_t>(std::count_if(turns.begin(), turns.end(), [](const Turn& turn) { return turn.split; }));
  const auto mistaken =
      shading.is_quantised ? static_cast<std::size_t>(kMistaken * static_cast<double>(turns.size())) : std::size_t{0};
  if (split <= mistaken) return 180;
  if (turns.size() - split > mistaken) return best_angle(turns);
  if (turns[turns.size() / 2].degrees < kCoarse) return std::nullopt;
  return 0;
}

}  // namespace curvecast
