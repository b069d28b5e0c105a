#include "server/convert/neighbour_chunks.h"

#include <cmath>
#include <utility>

#include "server/base/protocol.h"
#include "server/convert/field_validator.h"
#include "server/convert/little_endian.h"

namespace curvecast::server {
namespace {

constexpr std::size_t kMostCounts = 65'536, kMostNeighbours = 65'536;  // of a message: 768 KiB

}  // namespace

absl::StatusOr<NeighbourSearch> to_neighbour_search(const v1::FindNeighboursRequest& request) {
  FieldValidator check;
  NeighbourSearch out;
  switch (request.search_case()) {
    case v1::FindNeighboursRequest::kCount:
      out.count = check.in_range("count", request.count(), std::uint32_t{1}, kMaxNeighbours);
      break;
    case v1::FindNeighboursRequest::kRadius:
      out.radius = check.finite("radius", request.radius());
      if (!(out.radius > 0)) check.fail("radius", absl::StrCat("is ", out.radius, "; it must be above 0"));
      break;
    case v1::FindNeighboursRequest::SEARCH_NOT_SET:
      check.fail("count", "is not set, nor is radius; ask for one of the two");
  }
  if (!check.ok()) return check.status();
  return out;
}

bool NeighbourChunks::add(const NeighbourLists& lists) {
  counts_.insert(counts_.end(), lists.lengths.begin(), lists.lengths.end());
  if (counts_.size() >= kMostCounts && !flush()) return false;
  for (const Neighbour& neighbour : lists.neighbours) {
    indices_.push_back(neighbour.index);
    distances_.push_back(std::sqrt(neighbour.square));
    if (indices_.size() >= kMostNeighbours && !flush()) return false;
  }
  return true;
}

bool NeighbourChunks::finish() { return (counts_.empty() && indices_.empty()) || flush(); }

bool NeighbourChunks::flush() {
  v1::FindNeighboursResponse response;
  v1::NeighbourChunk& chunk = *response.mutable_neighbours();
  chunk.set_counts(little_endian(counts_, 0, counts_.size()));
  chunk.set_indices(little_endian(indices_, 0, indices_.size()));
  chunk.set_distances(little_endian(distances_, 0, distances_.size()));
  counts_.clear();
  indices_.clear();
  distances_.clear();
  return emit_(std::move(response));
}

}  // namespace curvecast::server
