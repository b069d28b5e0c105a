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

/// Rows of numbers and words under common headings.
struct BenchTable {
  std::string name;
  std::vector<std::string> columns;
  std::vector<std::vector<Json>> rows;  // a cell for each column; null: nothing
};

struct BenchReport {
  std::string name;  // of the benchmark
  std::vector<BenchResult> results;
  std::vector<std::string> notes = {};  // how it was measured; whole sentences
  std::vector<BenchTable> tables = {};
};

Json bench_json(const BenchReport& report);  // {name, machine, results[{case, value, unit, reference, ratio}], notes} and, where
                                             // there are any, tables[{name, rows[{column: cell}]}]
std::string bench_text(const BenchReport& report);  // the tables, and one of the results

/// Processor, number of cores, and how many processes want them now (the load average of the last minute): times taken on a busy
/// machine say so.
std::string machine_name();

}  // namespace curvecast::cli::bench
