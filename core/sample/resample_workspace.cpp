#include "core/sample/resample_workspace.h"

#include "core/base/capacity.h"

namespace curvecast {

std::size_t ResampleWorkspace::byte_size() const {
  const auto& [own_points, own_sequence, own_mass, own_equalise] = *this;
  return own_points.byte_size() + capacity_bytes(own_sequence) + own_mass.byte_size() + own_equalise.byte_size();
}

}  // namespace curvecast
