#include "server/low_priority.h"

#include <sys/resource.h>

namespace curvecast::server {

// (On Linux priorities belong to threads.)
void lower_priority() {
  constexpr int kNice = 10;
  setpriority(PRIO_PROCESS, 0, kNice);
}

}  // namespace curvecast::server
