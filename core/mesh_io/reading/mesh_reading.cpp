#include "core/mesh_io/reading/mesh_reading.h"

#include <absl/strings/str_format.h>

namespace curvecast {

std::string index_out_of_range(std::int64_t index, std::uint64_t vertices) {
  return absl::StrFormat("vertex index %d is out of range (the file has %d vertices)", index, vertices);
}

}  // namespace curvecast
