#include "server/base/build_info.h"

#include <absl/strings/str_cat.h>

namespace curvecast::server {

BuildInfo build_info() {
#ifdef __clang__
  return {CURVECAST_VERSION, __VERSION__, CURVECAST_BUILD_TYPE};
#else
  return {CURVECAST_VERSION, "GCC " __VERSION__, CURVECAST_BUILD_TYPE};
#endif
}

std::string describe(const BuildInfo& build) {
  return absl::StrCat("curvecast ", build.version, " (", build.compiler, ", ", build.type, ")");
}

}  // namespace curvecast::server
