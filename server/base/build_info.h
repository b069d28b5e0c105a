// The version of Curvecast that runs, and how it was built.
#pragma once

#include <string>

namespace curvecast::server {

struct BuildInfo {
  const char* version;
  const char* compiler;  // with its version
  const char* type;      // as CMake calls it, such as Release
};

BuildInfo build_info();
/// Puts all of it in one line.
std::string describe(const BuildInfo& build);

}  // namespace curvecast::server
