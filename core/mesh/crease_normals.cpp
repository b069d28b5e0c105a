#include "core/mesh/crease_normals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>

#include "core/base/for_all.h"

namespace curvecast {
namespace {

constexpr std::size_t kGrain = 4096;      // faces
constexpr std::size_t kInTurn = 1 << 18;  // halfedges or vertices between two looks whether the work was cancelled

/// What find_creases() is to compare with.
double crease_cosine(double degrees) {
  // Edges of 40 degrees, as of a prism of nine sides, are a little more or less where positions come from floats. They shall all
  // be the same.
  constexpr double kTolerance = 0.01;
  if (degrees <= 0) return 2;
  if (degrees >= 180) return -2;
  return std::cos(std::min(degrees + kTolerance, 180.0) * std::numbers::pi / 180);
}

double angle_at(const TriangleMesh& mesh, std::uint32_t h) {
  const Vec3d& apex = mesh.positions[mesh.from(h)];
  const Vec3d a = mesh.positions[mesh.to(h)] - apex, b = mesh.positions[mesh.from(previous_halfedge(h))] - apex;
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// Puts the parts of the vertices' fans together.
class Collector {
 public:
  /// `most`: as many normals, or fewer, will come.
  Collector(const TriangleMesh& mesh, std::size_t most) : mesh_(mesh), normal_of_(mesh.twins.size(), kNone) {
    out_.normals.reserve(most);
  }

  /// `part`: the halfedges that leave v into the faces of one part.
  void add(std::uint32_t v, std::span<const std::uint32_t> part) {
    Vec3d sum = Vec3d::Zero();
    for (const std::uint32_t h : part) sum += angle_at(mesh_, h) * area_vector(mesh_, h / 3).normalized();
    const double length = sum.norm();
    if (!(length > 0)) return;  // keeps the vertex's own
    for (const std::uint32_t h : part) normal_of_[h] = static_cast<std::uint32_t>(out_.normals.size());
    out_.normals.push_back({v, Vec3d(sum / length).cast<float>()});
  }

  CreaseNormals take() {
    if (out_.normals.size() < out_.normals.capacity() / 2) out_.normals.shrink_to_fit();  // creases that divide nothing
    const auto visit_faces = [&](auto&& visit) {
      for (std::uint32_t f = 0; f < mesh_.face_count(); ++f) {
        const CreaseFace face{f, {normal_of_[3 * f], normal_of_[3 * f + 1], normal_of_[3 * f + 2]}};
        if (face.normals != std::array<std::uint32_t, 3>{kNone, kNone, kNone}) visit(face);
      }
    };
    std::size_t count = 0;
    visit_faces([&](const CreaseFace& /*face*/) { ++count; });
    out_.faces.reserve(count);
    visit_faces([&](const CreaseFace& face) { out_.faces.push_back(face); });
    return std::move(out_);
  }

 private:
  const TriangleMesh& mesh_;
  std::vector<std::uint32_t> normal_of_;  // the corner from which a halfedge leaves
  CreaseNormals out_;
};

}  // namespace

std::vector<std::uint8_t> find_creases(const TriangleMesh& mesh, double cosine, const ExecutionContext& context) {
  std::vector<std::uint8_t> creases(mesh.twins.size());
  for_blocks(context, mesh.face_count(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const Vec3d here = area_vector(mesh, f);
      for (std::size_t h = 3 * f; h < 3 * f + 3; ++h) {
        const std::uint32_t twin = mesh.twins[h];
        if (twin == kNone) continue;
        const Vec3d there = area_vector(mesh, twin / 3);
        creases[h] = here.dot(there) < cosine * std::sqrt(here.squaredNorm() * there.squaredNorm());
      }
    }
  });
  return creases;
}

CreaseNormals crease_normals(const TriangleMesh& mesh, double degrees) {
  return crease_normals(mesh, degrees, VertexFans(mesh), {});
}

CreaseNormals crease_normals(const TriangleMesh& mesh, double degrees, const VertexFans& fans, const ExecutionContext& context) {
  const std::vector<std::uint8_t> creases = find_creases(mesh, crease_cosine(degrees), context);
  const auto count = [](const auto& of, std::uint32_t what) { return static_cast<std::size_t>(std::ranges::count(of, what)); };
  const std::size_t crease_count = count(creases, 1);
  if (crease_count == 0) return {};
  std::vector<std::uint8_t> has_crease(mesh.vertex_count());
  for_blocks_in_turn(context, creases.size(), kInTurn, [&](std::size_t begin, std::size_t end) {
    for (auto h = static_cast<std::uint32_t>(begin); h < end; ++h) {
      if (creases[h] != 0) has_crease[mesh.from(h)] = 1;
    }
  });
  // Counter-clockwise from the face of h, the next one lies beyond its last edge.
  const auto ends_part = [&](std::uint32_t h) { return creases[previous_halfedge(h)] != 0; };
  Collector collector(mesh, crease_count + count(mesh.twins, kNone));  // parts begin at creases, and at borders
  std::vector<std::uint32_t> fan;
  for (std::uint32_t v = 0; v < has_crease.size(); ++v) {
    if (has_crease[v] == 0) continue;
    if (context.cancelled()) break;
    fan.clear();
    fans.visit(v, [&](std::uint32_t h) { fan.push_back(h); });
    if (!fans.on_border(v)) {  // a ring: it is cut where a part ends
      if (std::count_if(fan.begin(), fan.end(), ends_part) < 2) continue;
      std::rotate(fan.begin(), std::find_if(fan.begin(), fan.end(), ends_part) + 1, fan.end());
    }
    for (std::size_t begin = 0, end = 0; begin < fan.size(); begin = end) {
      while (end < fan.size() && !ends_part(fan[end])) ++end;
      end = std::min(end + 1, fan.size());
      collector.add(v, std::span(fan).subspan(begin, end - begin));
    }
  }
  return collector.take();
}

}  // namespace curvecast
