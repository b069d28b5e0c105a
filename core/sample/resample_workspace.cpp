#include "core/sample/resample_workspace.h"

namespace curvecast {

std::size_t ResampleWorkspace::byte_size() const {
  const auto bytes = [](const auto&... vectors) { return ((vectors.capacity() * sizeof(vectors[0])) + ...); };
  return bytes(points.positions, points.normals, points.radii, points.vertices, points.ranks, points.colours, sequence, mass.sum,
               mass.codes, mass.own_codes, mass.moved, mass.close, equalise.block, selection.parts, selection.shown,
               selection.rungs, density, shown, refs, discs, delta.added, delta.removed, delta.resized, list_delta.added,
               list_delta.removed, list_delta.resized, list_delta.keys, list_delta.scratch, list_delta.places) +
         selector.byte_size();
}

}  // namespace curvecast
