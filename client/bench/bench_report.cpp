#include "client/bench/bench_report.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <thread>

namespace curvecast::cli::bench {

std::string machine_name() {
  std::string processor = "unknown processor";
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) {
      processor = line.substr(colon + 2);
      break;
    }
  }
  std::string name = absl::StrCat(processor, ", ", std::thread::hardware_concurrency(), " cores");
  double load = 0;
  if (getloadavg(&load, 1) == 1) absl::StrAppendFormat(&name, ", load %.1f", load);
  return name;
}

Json bench_json(const BenchReport& report) {
  Json results = Json::array();
  for (const BenchResult& result : report.results) {
    Json& json = results.emplace_back(Json{{"case", result.name}, {"value", result.value}, {"unit", result.unit}});
    if (!result.reference) continue;
    json["reference"] = *result.reference;
    json["ratio"] = result.value / *result.reference;
  }
  return {{"name", report.name}, {"machine", machine_name()}, {"results", std::move(results)}, {"notes", report.notes}};
}

std::string bench_text(const BenchReport& report) {
  std::size_t width = 4;
  for (const BenchResult& result : report.results) width = std::max(width, result.name.size());
  std::string text = absl::StrCat(report.name, " (", machine_name(), ")\n");
  absl::StrAppendFormat(&text, "%-*s %12s %-11s %12s %8s\n", width, "case", "value", "unit", "reference", "ratio");
  for (const BenchResult& result : report.results) {
    absl::StrAppendFormat(&text, "%-*s %12.5g %-11s", width, result.name, result.value, result.unit);
    if (result.reference) absl::StrAppendFormat(&text, " %12.5g %8.3f", *result.reference, result.value / *result.reference);
    absl::StrAppend(&text, "\n");
  }
  for (const std::string& note : report.notes) absl::StrAppend(&text, note, "\n");
  return text;
}

}  // namespace curvecast::cli::bench
