#include "core/base/machine.h"

#include <absl/strings/str_split.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <thread>
#include <vector>

namespace curvecast {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::max();

/// The number that a file begins with; the largest where it begins with none, such as "max".
double number_in(const std::string& path) {
  double number = 0;
  return std::ifstream(path) >> number && number >= 0 ? number : kNoLimit;
}

/// A quota of time in each period, in cores: version 2 has both in one file.
double cores_in(const std::string& path) {
  double quota = 0, period = 0;
  return std::ifstream(path) >> quota >> period && quota > 0 && period > 0 ? quota / period : kNoLimit;
}

double cores_in(const std::string& quota_path, const std::string& period_path) {
  const double quota = number_in(quota_path), period = number_in(period_path);
  return quota > 0 && quota < kNoLimit && period > 0 && period < kNoLimit ? quota / period : kNoLimit;
}

/// The least of a group's limits and of those around it.
class Least {
 public:
  void take_second(const std::string& folder) { take(number_in(folder + "/memory.max"), cores_in(folder + "/cpu.max")); }
  void take_first_memory(const std::string& folder) { take(number_in(folder + "/memory.limit_in_bytes"), kNoLimit); }
  void take_first_cores(const std::string& folder) {
    take(kNoLimit, cores_in(folder + "/cpu.cfs_quota_us", folder + "/cpu.cfs_period_us"));
  }
  GroupLimits limits() const {
    constexpr auto kMost = std::numeric_limits<std::uint64_t>::max();
    return {memory_ < static_cast<double>(kMost) ? static_cast<std::uint64_t>(memory_) : kMost, cores_};
  }

 private:
  void take(double memory, double cores) {
    memory_ = std::min(memory_, memory);
    cores_ = std::min(cores_, cores);
  }

  double memory_ = kNoLimit, cores_ = kNoLimit;
};

}  // namespace

GroupLimits read_group_limits(const std::string& root) {
  const std::string groups = root + "/sys/fs/cgroup";
  Least least;
  const auto take_all = [&](const std::string& hierarchy, const std::string& path, void (Least::*take)(const std::string&)) {
    for (std::string group = path; !group.empty(); group.resize(std::min(group.rfind('/'), group.size() - 1))) {
      (least.*take)(hierarchy + group);
    }
    (least.*take)(hierarchy);
  };
  // A line for each hierarchy, NUMBER:CONTROLLERS:/PATH; that of version 2 has no controllers. Within a container the path is its
  // root, as a rule, or one that only the machine around it knows.
  take_all(groups, "", &Least::take_second);
  take_all(groups + "/memory", "", &Least::take_first_memory);
  take_all(groups + "/cpu", "", &Least::take_first_cores);
  std::ifstream lines(root + "/proc/self/cgroup");
  for (std::string line; std::getline(lines, line);) {
    const std::vector<std::string> fields = absl::StrSplit(line, absl::MaxSplits(':', 2));
    if (fields.size() != 3) continue;
    if (fields[1].empty()) take_all(groups, fields[2], &Least::take_second);
    const std::vector<std::string> controllers = absl::StrSplit(fields[1], ',');
    for (const std::string& controller : controllers) {
      if (controller == "memory") take_all(groups + "/memory", fields[2], &Least::take_first_memory);
      if (controller == "cpu") take_all(groups + "/" + fields[1], fields[2], &Least::take_first_cores);
    }
  }
  return least.limits();
}

std::uint64_t machine_memory_bytes() {
  const auto machine =
      static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  return std::min(machine, read_group_limits().memory_bytes);
}

int machine_cores() {
  const double cores = std::min<double>(std::max(1U, std::thread::hardware_concurrency()), read_group_limits().cores);
  return std::max(1, static_cast<int>(std::ceil(cores)));
}

}  // namespace curvecast
