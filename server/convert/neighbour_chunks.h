// Converts what is asked of neighbours, and lists of neighbours to messages.
#pragma once

#include <absl/status/statusor.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "core/measure/neighbour_lists.h"
#include "curvecast/v1/curvecast.pb.h"

namespace curvecast::server {

/// Which others are a point's neighbours.
struct NeighbourSearch {
  std::uint32_t count = 0;  // so many that are nearest; 0: by the radius
  double radius = 0;        // all at most so far away, units
};

/// InvalidArgument names the field at fault and its value.
absl::StatusOr<NeighbourSearch> to_neighbour_search(const v1::FindNeighboursRequest& request);

/// Packs lists into messages of under 1 MiB.
class NeighbourChunks {
 public:
  using Emit = std::function<bool(v1::FindNeighboursResponse)>;

  /// Messages go to `emit`, which returns false when no more are wanted.
  explicit NeighbourChunks(Emit emit) : emit_(std::move(emit)) {}

  /// Adds lists, and emits each message that is full. False: `emit` returned false.
  bool add(const NeighbourLists& lists);
  /// Emits what is left. False as add().
  bool finish();

 private:
  bool flush();

  const Emit emit_;
  std::vector<std::uint32_t> counts_, indices_;  // of the next message
  std::vector<float> distances_;                 // of the next message
};

}  // namespace curvecast::server
