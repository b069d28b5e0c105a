#include "client/bench/picture/budget_mesh.h"

#include <algorithm>
#include <utility>

#include "client/bench/peers/meshoptimizer.h"
#include "client/bench/picture/decode_drc_mesh.h"
#include "client/lib/drc_mesh.h"
#include "core/mesh/repair.h"

namespace curvecast::cli::bench {
namespace {

constexpr int kPositionBits = 12;
constexpr double kNoCreases = 180;  // degrees
constexpr std::size_t kFewestFaces = 16;
constexpr double kCloseEnough = 0.97;  // of the bytes that there may be
constexpr int kMostTries = 6;

/// The vertices that triangles use, and the triangles of those, repaired.
absl::StatusOr<LoadedMesh> compact(const std::vector<std::uint32_t>& corners, const TriangleMesh& whole,
                                   const MeshAttributes& attributes) {
  PolygonSoup soup;
  soup.polygon_begin.push_back(0);
  std::vector<std::uint32_t> number(whole.positions.size(), kNone);
  for (const std::uint32_t corner : corners) {
    std::uint32_t& v = number[corner];
    if (v == kNone) {
      v = static_cast<std::uint32_t>(soup.positions.size());
      soup.positions.push_back(whole.positions[corner]);
      if (!attributes.colours.empty()) soup.attributes.colours.push_back(attributes.colours[corner]);
    }
    soup.indices.push_back(v);
    if (soup.indices.size() % 3 == 0) soup.polygon_begin.push_back(static_cast<std::uint32_t>(soup.indices.size()));
  }
  absl::StatusOr<RepairedMesh> repaired = repair(std::move(soup));
  if (!repaired.ok()) return repaired.status();
  return LoadedMesh{std::move(repaired->mesh), std::move(repaired->attributes), std::move(repaired->sources), {}};
}

absl::StatusOr<std::string> encoded(const LoadedMesh& loaded) {
  client::Mesh mesh;
  for (const Vec3d& p : loaded.mesh.positions)
    mesh.vertices.positions.push_back({static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())});
  for (const Rgba8& c : loaded.attributes.colours) mesh.vertices.colours.push_back({c.r, c.g, c.b});
  for (const Triangle& t : loaded.mesh.triangles) mesh.triangles.push_back({t[0], t[1], t[2]});
  return client::make_drc_mesh(mesh, {.position_bits = kPositionBits});
}

}  // namespace

BudgetMeshes::BudgetMeshes(const ShadedMesh& whole) : whole_(whole) {
  for (const Vec3d& p : whole.mesh().positions) positions_.push_back(p.cast<float>());
  levels_.push_back({corners_of(whole.mesh()), 0});
}

absl::StatusOr<BudgetMeshes::Level> BudgetMeshes::simplified(std::size_t faces) const {
  const auto from =
      std::find_if(levels_.rbegin(), levels_.rend(), [&](const Level& level) { return level.corners.size() >= 3 * faces; });
  Level level{from == levels_.rend() ? levels_.front().corners : from->corners};
  if (level.corners.size() > 3 * faces) simplify(positions_, level.corners, faces);
  const absl::StatusOr<LoadedMesh> mesh = compact(level.corners, whole_.mesh(), whole_.attributes());
  if (!mesh.ok()) return mesh.status();
  const absl::StatusOr<std::string> bytes = encoded(*mesh);
  if (!bytes.ok()) return bytes.status();
  level.bytes = bytes->size();
  return level;
}

absl::StatusOr<BudgetMesh> BudgetMeshes::of_bytes(std::uint64_t bytes, const ExecutionContext& context) {
  while (levels_.back().bytes == 0 || (levels_.back().bytes > bytes && levels_.back().corners.size() / 6 >= kFewestFaces)) {
    if (absl::Status status = context.check(); !status.ok()) return status;
    const bool is_first = levels_.back().bytes == 0;
    absl::StatusOr<Level> next = simplified(levels_.back().corners.size() / (is_first ? 3 : 6));
    if (!next.ok()) return next.status();
    const bool is_stuck = !is_first && next->corners.size() > levels_.back().corners.size() / 10 * 9;
    if (is_first) levels_.pop_back();
    levels_.push_back(*std::move(next));
    if (is_stuck) break;
  }
  // Between the last level that is too large and the first that is not, by the bytes of a triangle.
  const auto fits = std::find_if(levels_.begin(), levels_.end(), [&](const Level& level) { return level.bytes <= bytes; });
  Level best = fits != levels_.end() ? *fits : levels_.back();
  std::size_t most =
      fits != levels_.end() && fits != levels_.begin() ? std::prev(fits)->corners.size() / 3 : best.corners.size() / 3;
  for (int i = 0;
       i < kMostTries && best.bytes <= bytes && static_cast<double>(best.bytes) < kCloseEnough * static_cast<double>(bytes);
       ++i) {
    if (absl::Status status = context.check(); !status.ok()) return status;
    const std::size_t least = best.corners.size() / 3;
    const double wanted = static_cast<double>(least) * static_cast<double>(bytes) / static_cast<double>(best.bytes) * 0.985;
    const std::size_t faces = std::clamp(static_cast<std::size_t>(wanted), least, most);
    if (faces <= least) break;
    absl::StatusOr<Level> next = simplified(faces);
    if (!next.ok()) return next.status();
    if (next->bytes > bytes) {
      most = next->corners.size() / 3 - 1;
    } else if (next->corners.size() > best.corners.size()) {
      best = *std::move(next);
    } else {
      break;
    }
  }
  const absl::StatusOr<LoadedMesh> mesh = compact(best.corners, whole_.mesh(), whole_.attributes());
  if (!mesh.ok()) return mesh.status();
  const absl::StatusOr<std::string> drc = encoded(*mesh);
  if (!drc.ok()) return drc.status();
  absl::StatusOr<LoadedMesh> sent = decode_drc_mesh(*drc, Vec3d::Zero());
  if (!sent.ok()) return sent.status();
  auto creased = std::make_unique<const ShadedMesh>(*sent, whole_.crease_degrees());
  return BudgetMesh{std::move(creased), std::make_unique<const ShadedMesh>(*std::move(sent), kNoCreases), drc->size()};
}

}  // namespace curvecast::cli::bench
