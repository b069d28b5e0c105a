#include "server/base/process_usage.h"

#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <system_error>

namespace curvecast::server {
namespace {

std::uint64_t count_entries(const char* folder) {
  std::error_code error;
  std::uint64_t count = 0;
  for (std::filesystem::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) ++count;
  return count;
}

struct Pages {
  std::uint64_t resident = 0, shared = 0;  // bytes; what is shared with files is resident too
};

Pages pages() {
  std::uint64_t total = 0;
  Pages out;
  if (!(std::ifstream("/proc/self/statm") >> total >> out.resident >> out.shared)) return {};
  const auto size = static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  return {out.resident * size, out.shared * size};
}

double seconds(const timeval& time) { return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec); }

}  // namespace

ProcessUsage process_usage() {
  ProcessUsage out;
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  out.cpu_seconds = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  out.resident_bytes = pages().resident;
  out.open_files = count_entries("/proc/self/fd");
  out.threads = count_entries("/proc/self/task");
  return out;
}

std::uint64_t anonymous_bytes() {
  const Pages now = pages();
  return now.resident - now.shared;
}

}  // namespace curvecast::server
