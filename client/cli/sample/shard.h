// Which part of a list one of several processes works on.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <functional>
#include <string>

namespace curvecast::cli {

/// Entry `i` of a list belongs to shard i modulo count.
struct Shard {
  std::uint64_t index = 0, count = 1;

  bool holds(std::uint64_t entry) const { return entry % count == index; }
};

/// Stands for what the environment says.
inline constexpr char kAuto[] = "auto";

/// Returns a variable of the environment; empty where it is not set.
using GetVariable = std::function<std::string(const std::string& name)>;

/// Reads "I/N", I from 0 on, or "auto": what the environment of an indexed job of Kubernetes (JOB_COMPLETION_INDEX, which `count`
/// has to go with) or of an array of Slurm (SLURM_ARRAY_TASK_ID, _MIN, _MAX, _COUNT: an array without gaps from 0 on, or any with
/// `count`) says. `count`: N of "auto"; 0: not given. InvalidArgument says what is wrong.
absl::StatusOr<Shard> parse_shard(const std::string& text, std::uint64_t count, const GetVariable& variable);

}  // namespace curvecast::cli
