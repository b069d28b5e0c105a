#include "server/frame/scattered_blocks.h"

#include <optional>
#include <utility>
#include <vector>

#include "core/base/memory_claim.h"
#include "core/base/stopwatch.h"
#include "server/convert/convert_points.h"
#include "server/frame/pack_points.h"
#include "server/frame/point_blocks.h"
#include "server/frame/view_lattice.h"

namespace curvecast::server {

absl::Status make_scattered_blocks(const LoadedMesh& mesh, const ScatterRequest& request, const ExecutionContext& context,
                                   const std::function<bool(v1::ResampleResponse)>& emit) {
  Stopwatch watch;
  const Box3d& box = mesh.info.box;
  absl::StatusOr<ScatteredPoints> scattered = scatter_mesh(mesh, request.scatter, context);
  if (!scattered.ok()) return scattered.status();
  PointSet& points = scattered->points;
  MemoryClaim claim(context);
  if (absl::Status status = claim_points(points.size(), claim); !status.ok()) return status;
  const ViewLattice lattice = lattice_need(request.point_set, box, points).best;
  move_origin(lattice, points);
  const std::optional<DracoOptions> draco = draco_options(request.point_set, lattice);
  const PointAttributes& wanted = request.point_set.attributes;
  PointSetStatistics statistics{.equalise_seconds = watch.lap(), .wanted_points = points.size()};
  const auto encode = [&](std::size_t begin, std::size_t count) {
    absl::StatusOr<v1::PointBlock> block = to_proto(points, begin, count, box, draco);
    if (block.ok() && wanted != PointAttributes()) {
      *block->mutable_attributes() = to_proto(*scattered, begin, count, wanted.surface);
    }
    return block;
  };
  return emit_blocks(
      points.size(),
      [&](std::size_t first, std::size_t last) {
        absl::StatusOr<std::vector<v1::PointBlock>> blocks = encode_blocks(points.size(), first, last, encode);
        statistics.encode_seconds += watch.lap();
        return blocks;
      },
      statistics, false, emit);
}

}  // namespace curvecast::server
