#include "core/progressive/ranked_workspace.h"

#include "core/base/capacity.h"

namespace curvecast {

std::size_t RankedWorkspace::byte_size() const {
  const auto& [own_points, own_selection, own_selector, own_density, own_shown, own_refs, own_discs, own_delta, own_list_delta] =
      *this;
  return own_points.byte_size() + own_selection.byte_size() + own_selector.byte_size() +
         capacity_bytes(own_density, own_shown, own_refs, own_discs) + own_delta.byte_size() + own_list_delta.byte_size();
}

}  // namespace curvecast
