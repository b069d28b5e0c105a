#include "client/bench/picture/sent_surface.h"

#include <utility>

#include "client/bench/picture/decode_drc_mesh.h"
#include "client/lib/client.h"

namespace curvecast::cli::bench {
namespace {

constexpr double kBytesPerFace = 1.5, kBytesPerPoint = 3.4, kMeshBytes = 300;

}  // namespace

absl::StatusOr<SentSurface> fetch_surface(const std::shared_ptr<client::Connection>& connection, const std::string& session_id) {
  v1::GetSurfaceRequest request;
  request.set_session_id(session_id);
  const absl::StatusOr<client::Surface> surface = client::Client(connection).get_surface(request);
  if (!surface.ok()) return surface.status();
  const v1::Vec3& origin = surface->info.origin();
  absl::StatusOr<LoadedMesh> loaded = decode_drc_mesh(surface->drc, {origin.x(), origin.y(), origin.z()});
  if (!loaded.ok()) return loaded.status();
  return SentSurface{std::make_unique<const ShadedMesh>(*std::move(loaded), surface->info.crease_degrees()), surface->drc.size()};
}

bool is_mesh_better(std::uint64_t faces, std::uint64_t bytes_so_far, std::uint64_t next_points) {
  return static_cast<double>(bytes_so_far) + kBytesPerPoint * static_cast<double>(next_points) >
         kBytesPerFace * static_cast<double>(faces) + kMeshBytes;
}

}  // namespace curvecast::cli::bench
