// What a frame holds, whatever blocks it comes in.
#pragma once

#include <cstdint>
#include <string>

#include "curvecast/v1/curvecast.pb.h"

namespace curvecast::server {

inline std::uint64_t count_points(const v1::PointFrame& frame) {
  std::uint64_t count = 0;
  for (const v1::PointBlock& block : frame.points()) count += block.count();
  return count;
}

inline std::string point_bytes(const v1::PointFrame& frame) {
  std::string bytes;
  for (const v1::PointBlock& block : frame.points()) bytes += block.SerializeAsString();
  return bytes;
}

}  // namespace curvecast::server
