#include "core/remesh/insert_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/base/random.h"

namespace curvecast {
namespace {

// The least weight of a corner: points nearer to an edge are put that far from it.
constexpr float kLeastWeight = 1e-5f;
// By which points are moved off the lines that they share with others: less than kLeastWeight.
constexpr float kBeside = 8e-6f;
// Of a part's area: the least third that is worth looking for.
constexpr double kThin = 1e-4;

/// A place within a face, by the weights of its second and third corner.
struct Local {
  float u, v;
  bool operator<(const Local& other) const { return u != other.u ? u < other.u : v < other.v; }
  bool operator==(const Local& other) const { return u == other.u && v == other.v; }
};

/// Twice the area of a, b, c. Its sign is exact: differences and products of floats fit into a double, but for those that differ
/// by more than its digits, where the larger decides.
double orientation(const Local& a, const Local& b, const Local& c) {
  const double bu = static_cast<double>(b.u) - a.u, bv = static_cast<double>(b.v) - a.v;
  const double cu = static_cast<double>(c.u) - a.u, cv = static_cast<double>(c.v) - a.v;
  return bu * cv - bv * cu;
}

Local inside(const FacePlace& place) {
  const float u = std::max(place.weight_1, kLeastWeight), v = std::max(place.weight_2, kLeastWeight);
  const float room = 1 - kLeastWeight, sum = u + v;
  return sum > room ? Local{u / sum * room, v / sum * room} : Local{u, v};
}

struct Point {
  Local at;
  std::uint32_t vertex;
};

/// Returns a place next to a point's: points of regular samplings lie on many lines with others and with corners, and triangles
/// between them would have no area.
Local beside(const Point& point) {
  const std::uint64_t bits = mix_bits(point.vertex);
  const auto step = [](std::uint64_t some) { return kBeside * (static_cast<float>(some & 0xffff) / 0xffff - 0.5f); };
  return {point.at.u + step(bits), point.at.v + step(bits >> 16)};
}

/// Puts points into one face.
class FaceFiller {
 public:
  explicit FaceFiller(HalfedgeMesh& mesh) : mesh_(mesh) {}

  void fill(std::uint32_t face, std::span<Point> points) {
    move_apart(points);
    for (Point& p : points) p.at = beside(p);
    const Triangle& t = mesh_.triangles[face];
    const Vec3d origin = mesh_.positions[t[0]], along = mesh_.positions[t[1]] - origin, up = mesh_.positions[t[2]] - origin;
    for (const Point& p : points) {
      mesh_.positions[p.vertex] = origin + static_cast<double>(p.at.u) * along + static_cast<double>(p.at.v) * up;
    }
    open_.assign(1, {face, {Local{0, 0}, Local{1, 0}, Local{0, 1}}, points});
    while (!open_.empty()) {
      const Part part = open_.back();
      open_.pop_back();
      split(part);
    }
  }

 private:
  struct Part {
    std::uint32_t face;
    std::array<Local, 3> corners;
    std::span<Point> points;
  };

  /// Points at the same place go towards the middle of the face, each by a step of its own.
  void move_apart(std::span<Point> points) {
    if (points.size() == 1) return;
    const auto is_before = [](const Point& a, const Point& b) { return a.at == b.at ? a.vertex < b.vertex : a.at < b.at; };
    for (bool is_done = false; !is_done;) {
      is_done = true;
      std::sort(points.begin(), points.end(), is_before);
      for (std::size_t i = 1; i < points.size(); ++i) {
        if (!(points[i].at == points[i - 1].at)) continue;
        is_done = false;
        Local& at = points[i].at;
        const float step = 1e-3f * static_cast<float>(1 + points[i].vertex % 64);
        at = {at.u + (0.3f - at.u) * step, at.v + (0.4f - at.v) * step};
      }
    }
  }

  /// The point that leaves the most even thirds comes first; where all are next to a side, the middle one along it.
  static void choose(const Part& part) {
    const auto& [a, b, c] = part.corners;
    std::size_t best = 0;
    double most = -1;
    for (std::size_t i = 0; i < part.points.size(); ++i) {
      const Local& p = part.points[i].at;
      const double least = std::min({orientation(a, b, p), orientation(b, c, p), orientation(c, a, p)});
      if (least > most) most = least, best = i;
    }
    if (most < kThin * orientation(a, b, c)) {
      best = part.points.size() / 2;
      std::nth_element(part.points.begin(), part.points.begin() + static_cast<std::ptrdiff_t>(best), part.points.end(),
                       [](const Point& p, const Point& q) { return p.at < q.at; });
    }
    std::swap(part.points[0], part.points[best]);
  }

  void split(const Part& part) {
    choose(part);
    const Local a = part.corners[0], b = part.corners[1], c = part.corners[2];
    const Local p = part.points[0].at;
    const auto second = static_cast<std::uint32_t>(mesh_.face_count());
    mesh_.split_face(part.face, part.points[0].vertex);  // (a, b, p), (b, c, p), (c, a, p)
    const std::span<Point> rest = part.points.subspan(1);
    const auto in_first = [&](const Point& q) { return orientation(p, a, q.at) >= 0 && orientation(p, b, q.at) < 0; };
    const auto in_second = [&](const Point& q) { return orientation(p, b, q.at) >= 0 && orientation(p, c, q.at) < 0; };
    const auto end_of_first = std::partition(rest.begin(), rest.end(), in_first);
    const auto end_of_second = std::partition(end_of_first, rest.end(), in_second);
    const auto add = [&](std::uint32_t face, const Local& from, const Local& to, std::span<Point> points) {
      if (!points.empty()) open_.push_back({face, {from, to, p}, points});
    };
    add(part.face, a, b, {rest.begin(), end_of_first});
    add(second, b, c, {end_of_first, end_of_second});
    add(second + 1, c, a, {end_of_second, rest.end()});
  }

  HalfedgeMesh& mesh_;
  std::vector<Part> open_;
};

}  // namespace

void insert_points(HalfedgeMesh& mesh, std::span<const FacePlace> points) {
  std::vector<std::uint32_t> order(points.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) {
    return points[i].face != points[j].face ? points[i].face < points[j].face : i < j;
  });
  const auto first = static_cast<std::uint32_t>(mesh.vertex_count());
  for (std::size_t i = 0; i < points.size(); ++i) mesh.add_vertex(Vec3d::Zero());
  FaceFiller filler(mesh);
  std::vector<Point> group;
  for (std::size_t i = 0; i < order.size();) {
    const std::uint32_t face = points[order[i]].face;
    group.clear();
    for (; i < order.size() && points[order[i]].face == face; ++i) group.push_back({inside(points[order[i]]), first + order[i]});
    filler.fill(face, group);
  }
}

void insert_line_points(HalfedgeMesh& mesh, const TriangleMesh& surface, std::span<const LinePlace> points) {
  for (std::size_t i = 0; i < points.size();) {
    const std::uint32_t edge = points[i].halfedge, from = surface.from(edge), to = surface.to(edge);
    std::uint32_t h = kNone;  // that runs there now
    mesh.for_each_outgoing(from, [&](std::uint32_t out) {
      if (mesh.to(out) == to && (mesh.twins[out] == kNone || mesh.is_feature(out))) h = out;
    });
    const Vec3d a = mesh.positions[from], along = mesh.positions[to] - a;
    for (; i < points.size() && points[i].halfedge == edge; ++i) {
      const std::uint32_t v = mesh.add_vertex(a + points[i].part * along);
      h = mesh.split_edge(h, v);
    }
  }
}

}  // namespace curvecast
