#include "server/session/eviction.h"

#include <algorithm>
#include <utility>

namespace curvecast::server {

Eviction choose_evicted(std::vector<Resident> residents, const SessionLimits& limits) {
  std::size_t sessions = residents.size();
  std::uint64_t bytes = 0;
  for (const Resident& resident : residents) bytes += resident.bytes;
  std::erase_if(residents, [](const Resident& resident) { return !resident.may_go; });
  std::ranges::sort(residents, {}, [](const Resident& resident) { return std::pair(resident.is_unsaved, resident.last_used); });
  Eviction out;
  for (Resident& oldest : residents) {
    if (sessions <= limits.sessions && bytes <= limits.bytes) break;
    // Where there are not too many, one that takes next to nothing would go in vain.
    if (sessions <= limits.sessions && oldest.bytes == 0) continue;
    --sessions;
    bytes -= oldest.bytes;
    out.ids.push_back(std::move(oldest.id));
  }
  out.is_enough = sessions <= limits.sessions && bytes <= limits.bytes;
  out.sessions = sessions, out.bytes = bytes;
  return out;
}

}  // namespace curvecast::server
