// How a fuzzer says that a promise is broken.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <string>

namespace curvecast::fuzzing {

inline void expect(bool good, const std::string& what) {
  if (good) return;
  std::fprintf(stderr, "broken promise: %s\n", what.c_str());
  std::abort();
}

}  // namespace curvecast::fuzzing
