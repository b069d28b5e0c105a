#include "client/bench/peak_memory.h"

#include <malloc.h>

#include <fstream>
#include <sstream>
#include <string>

namespace curvecast::cli::bench {

bool reset_peak_memory() {
  malloc_trim(0);
  std::ofstream file("/proc/self/clear_refs");
  file << "5" << std::flush;
  return file.good();
}

std::uint64_t peak_memory() {
  std::ifstream file("/proc/self/status");
  for (std::string line; std::getline(file, line);) {
    std::uint64_t kibibytes = 0;
    std::string key;
    if (std::istringstream(line) >> key >> kibibytes && key == "VmHWM:") return 1024 * kibibytes;
  }
  return 0;
}

}  // namespace curvecast::cli::bench
