#include "client/cli/sample/shard.h"

#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_split.h>

#include <utility>

namespace curvecast::cli {
namespace {

constexpr char kKubernetes[] = "JOB_COMPLETION_INDEX";
constexpr char kSlurm[] = "SLURM_ARRAY_TASK_ID";

absl::StatusOr<std::uint64_t> number(const GetVariable& variable, const std::string& name) {
  const std::string text = variable(name);
  std::uint64_t value = 0;
  if (absl::SimpleAtoi(text, &value)) return value;
  return absl::InvalidArgumentError(absl::StrCat("shard: $", name, " is '", text, "', not a number"));
}

absl::StatusOr<Shard> checked(Shard shard, const std::string& text) {
  if (shard.index < shard.count) return shard;
  return absl::InvalidArgumentError(
      absl::StrCat("shard: ", text, ": of ", shard.count, " shards the first is 0 and the last ", shard.count - 1));
}

/// How many tasks an array has whose numbers are 0, 1, 2 and so on.
absl::StatusOr<std::uint64_t> slurm_count(const GetVariable& variable) {
  const absl::StatusOr<std::uint64_t> first = number(variable, "SLURM_ARRAY_TASK_MIN");
  const absl::StatusOr<std::uint64_t> last = number(variable, "SLURM_ARRAY_TASK_MAX");
  const absl::StatusOr<std::uint64_t> count = number(variable, "SLURM_ARRAY_TASK_COUNT");
  for (const auto* value : {&first, &last, &count}) {
    if (!value->ok()) return value->status();
  }
  if (*first == 0 && *last + 1 == *count) return *count;
  return absl::InvalidArgumentError(absl::StrCat("shard: the array's tasks are ", *count, " from ", *first, " to ", *last,
                                                 ", not all from 0 on: say with --shards how many shards there are"));
}

absl::StatusOr<Shard> from_environment(std::uint64_t count, const GetVariable& variable) {
  const bool is_kubernetes = !variable(kKubernetes).empty(), is_slurm = !variable(kSlurm).empty();
  if (is_kubernetes == is_slurm) {
    return absl::InvalidArgumentError(absl::StrCat("shard: auto takes its number from $", kKubernetes, " or $", kSlurm, ", and ",
                                                   is_kubernetes ? "both are set" : "neither is set"));
  }
  const std::string name = is_kubernetes ? kKubernetes : kSlurm;
  const absl::StatusOr<std::uint64_t> index = number(variable, name);
  if (!index.ok()) return index.status();
  if (count == 0 && is_kubernetes) {
    return absl::InvalidArgumentError("shard: Kubernetes does not say how many shards there are: say it with --shards");
  }
  const absl::StatusOr<std::uint64_t> total = count == 0 ? slurm_count(variable) : count;
  if (!total.ok()) return total.status();
  return checked({*index, *total}, absl::StrCat("$", name, " is ", *index));
}

}  // namespace

absl::StatusOr<Shard> parse_shard(const std::string& text, std::uint64_t count, const GetVariable& variable) {
  if (text == kAuto) return from_environment(count, variable);
  if (count != 0) return absl::InvalidArgumentError("shard: --shards goes with --shard auto; else say --shard I/N");
  const std::pair<std::string, std::string> parts = absl::StrSplit(text, absl::MaxSplits('/', 1));
  Shard shard;
  if (!absl::SimpleAtoi(parts.first, &shard.index) || !absl::SimpleAtoi(parts.second, &shard.count) || shard.count == 0) {
    return absl::InvalidArgumentError(absl::StrCat("shard: '", text, "' is neither I/N, such as 0/4, nor auto"));
  }
  return checked(shard, text);
}

}  // namespace curvecast::cli
