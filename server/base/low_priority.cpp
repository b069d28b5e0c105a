#include "server/base/low_priority.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>

namespace curvecast::server {

// (On Linux priorities belong to threads.)
void lower_priority() {
  // Below the main thread's, which may be low already.
  constexpr int kLower = 10, kLowest = 19;
  setpriority(PRIO_PROCESS, 0, std::min(getpriority(PRIO_PROCESS, static_cast<id_t>(getpid())) + kLower, kLowest));
}

}  // namespace curvecast::server
