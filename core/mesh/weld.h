// Finds vertices at the same place.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/execution_context.h"
#include "core/base/vec.h"

namespace curvecast {

struct Weld {
  std::vector<std::uint32_t> map;  // for each vertex the first of `candidates` at exactly its place, itself if it is none of them
  std::uint64_t welded = 0;        // vertices that are mapped to another
};

/// `candidates`: indices of vertices, ascending. O(n log n) whatever the places. Once the context is cancelled some are missing.
Weld weld(const std::vector<Vec3d>& positions, std::span<const std::uint32_t> candidates, const ExecutionContext& context = {});

}  // namespace curvecast
