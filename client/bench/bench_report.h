// What a benchmark found, as JSON and as text.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace curvecast::cli::bench {

using Json = nlohmann::ordered_json;

struct BenchResult {
  std::string name;  // of the case
  double value = 0;
  std::string unit;
  std::optional<double> reference = {};  // what it is compared with, in the same unit
};

struct BenchReport {
  std::string name;  // of the benchmark
  std::vector<BenchResult> results;
  std::vector<std::string> notes = {};  // how it was measured; whole sentences
};

Json bench_json(const BenchReport& report);         // {name, machine, results[{case, value, unit, reference, ratio}], notes}
std::string bench_text(const BenchReport& report);  // a table

/// Processor, number of cores, and how many processes want them now (the load average of the last minute): times taken on a busy
/// machine say so.
std::string machine_name();

}  // namespace curvecast::cli::bench
