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
  Json json = {{"name", report.name}, {"machine", machine_name()}, {"results", std::move(results)}, {"notes", report.notes}};
  for (const BenchTable& table : report.tables) {
    Json rows = Json::array();
    for (const std::vector<Json>& row : table.rows) {
      Json& cells = rows.emplace_back(Json::object());
      for (std::size_t c = 0; c < row.size(); ++c) cells[table.columns[c]] = row[c];
    }
    json["tables"].push_back({{"name", table.name}, {"rows", std::move(rows)}});
  }
  return json;
}

namespace {

std::string cell_text(const Json& cell) {
  if (cell.is_null()) return "-";
  if (cell.is_string()) return cell.get<std::string>();
  return cell.is_number_float() ? absl::StrFormat("%.4g", cell.get<double>()) : cell.dump();
}

std::string table_text(const BenchTable& table) {
  std::string text = absl::StrCat(table.name, "\n");
  std::vector<std::size_t> widths;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    widths.push_back(table.columns[c].size());
    for (const std::vector<Json>& row : table.rows) widths[c] = std::max(widths[c], cell_text(row[c]).size());
  }
  const auto append = [&](std::size_t c, const std::string& cell) {
    absl::StrAppendFormat(&text, "%*s%s", widths[c], cell, c + 1 < widths.size() ? "  " : "\n");
  };
  for (std::size_t c = 0; c < widths.size(); ++c) append(c, table.columns[c]);
  for (const std::vector<Json>& row : table.rows) {
    for (std::size_t c = 0; c < widths.size(); ++c) append(c, cell_text(row[c]));
  }
  return text;
}

}  // namespace

std::string bench_text(const BenchReport& report) {
  std::size_t width = 4;
  for (const BenchResult& result : report.results) width = std::max(width, result.name.size());
  std::string text = absl::StrCat(report.name, " (", machine_name(), ")\n");
  for (const BenchTable& table : report.tables) text += table_text(table);
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
