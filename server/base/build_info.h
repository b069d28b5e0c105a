// Which Curvecast this is.
#pragma once

#include <string>

namespace curvecast::server {

struct BuildInfo {
  const char* version;
  const char* compiler;  // with its version
  const char* type;      // as CMake calls it, such as Release
};

BuildInfo build_info();
/// All of it in one line.
std::string describe(const BuildInfo& build);

}  // namespace curvecast::server
