#include "client/bench/corpus_table.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/str_join.h>
#include <absl/strings/str_replace.h>

#include <array>
#include <utility>

namespace curvecast::cli::bench {
namespace {

constexpr std::array<const char*, 4> kVerdicts = {"passed", "failed", "refused", "nothing to sample"};

const char* name_of(Verdict verdict) { return kVerdicts[static_cast<std::size_t>(verdict)]; }

/// What repair did, without what it did not do: "welded 12, flipped 3".
std::string repairs_text(const RepairReport& repairs) {
  const std::array<std::pair<const char*, std::uint64_t>, 8> counts = {{{"triangulated", repairs.triangulated_polygons},
                                                                        {"degenerate", repairs.degenerate_faces},
                                                                        {"duplicate", repairs.duplicate_faces},
                                                                        {"welded", repairs.welded_vertices},
                                                                        {"unused", repairs.unused_vertices},
                                                                        {"flipped", repairs.flipped_faces},
                                                                        {"non-manifold", repairs.nonmanifold_edges},
                                                                        {"split", repairs.split_vertices}}};
  std::string text;
  for (const auto& [name, count] : counts) {
    if (count > 0) absl::StrAppend(&text, text.empty() ? "" : ", ", name, " ", count);
  }
  return text;
}

using Cell = std::pair<const char*, std::string>;  // heading and value

std::vector<Cell> cells(const CorpusEntry& entry) {
  const bool came_through = entry.verdict == Verdict::kPassed || entry.verdict == Verdict::kFailed;
  const PreprocessReport& report = entry.report;
  const auto value = [&](const auto& number) { return came_through ? absl::StrCat(number) : std::string(); };
  const auto shortened = [&](double number) { return came_through ? absl::StrFormat("%.3g", number) : std::string(); };
  const auto error = [&](double number) { return came_through ? absl::StrFormat("%.1e", number) : std::string(); };
  return {{"file", entry.name},
          {"result", name_of(entry.verdict)},
          {"format", report.mesh.format},
          {"vertices", value(report.mesh.vertices)},
          {"faces", value(report.mesh.faces)},
          {"components", value(report.mesh.components)},
          {"genus", value(report.mesh.genus)},
          {"border loops", value(report.mesh.boundary_loops)},
          {"repairs", repairs_text(report.mesh.repairs)},
          {"discs", value(report.discs)},
          {"curve vertices", value(report.curve_vertices)},
          {"deepest level", value(report.max_level)},
          {"flipped", value(report.flipped_triangles)},
          {"area error", error(entry.area_error)},
          {"area element error", error(report.area_error)},
          {"distortion p50", shortened(report.distortion.p50)},
          {"p99", shortened(report.distortion.p99)},
          {"p99.9", shortened(report.distortion.p999)},
          {"density p99.9", shortened(report.distortion.density_p999)},
          {"max", shortened(report.distortion.max)},
          {"off the surface (1e-9 diagonals)", shortened(1e9 * entry.sample_distance)},
          {"seconds", absl::StrFormat("%.2f", entry.seconds)},
          {"peak MB", entry.peak_bytes > 0 ? absl::StrFormat("%.0f", 1e-6 * static_cast<double>(entry.peak_bytes)) : ""},
          {"message", entry.message}};
}

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  return absl::StrCat("\"", absl::StrReplaceAll(text, {{"\"", "\"\""}}), "\"");
}

std::string escaped(const std::string& text) { return absl::StrReplaceAll(text, {{"|", "\\|"}, {"\n", " "}}); }

}  // namespace

std::string corpus_markdown(const std::vector<CorpusEntry>& entries) {
  std::string text = "|", rule = "|";
  for (const Cell& cell : cells({})) {
    absl::StrAppend(&text, " ", cell.first, " |");
    absl::StrAppend(&rule, "---|");
  }
  absl::StrAppend(&text, "\n", rule, "\n");
  for (const CorpusEntry& entry : entries) {
    absl::StrAppend(&text, "|");
    for (const Cell& cell : cells(entry)) absl::StrAppend(&text, " ", escaped(cell.second), " |");
    absl::StrAppend(&text, "\n");
  }
  return absl::StrCat(text, "\n```\n", bench_text(summarise_corpus(entries)), "```\n");
}

std::string corpus_csv(const std::vector<CorpusEntry>& entries) {
  const auto joined = [](const std::vector<Cell>& row, auto&& part) {
    return absl::StrJoin(row, ",", [&](std::string* out, const Cell& cell) { absl::StrAppend(out, quoted(part(cell))); });
  };
  std::string text = joined(cells({}), [](const Cell& cell) { return std::string(cell.first); }) + "\r\n";
  for (const CorpusEntry& entry : entries) {
    absl::StrAppend(&text, joined(cells(entry), [](const Cell& cell) { return cell.second; }), "\r\n");
  }
  return text;
}

Json corpus_json(const std::vector<CorpusEntry>& entries) {
  Json json = bench_json(summarise_corpus(entries));
  json["files"] = Json::array();
  for (const CorpusEntry& entry : entries) {
    const PreprocessReport& report = entry.report;
    json["files"].push_back({{"file", entry.name},
                             {"result", name_of(entry.verdict)},
                             {"message", entry.message},
                             {"format", report.mesh.format},
                             {"faces", report.mesh.faces},
                             {"discs", report.discs},
                             {"flipped_triangles", report.flipped_triangles},
                             {"area_error", entry.area_error},
                             {"area_element_error", report.area_error},
                             {"distortion",
                              {{"p50", report.distortion.p50},
                               {"p99", report.distortion.p99},
                               {"p999", report.distortion.p999},
                               {"density_p999", report.distortion.density_p999},
                               {"max", report.distortion.max}}},
                             {"max_level", report.max_level},
                             {"sample_distance", entry.sample_distance},
                             {"seconds", entry.seconds},
                             {"peak_bytes", entry.peak_bytes}});
  }
  return json;
}

}  // namespace curvecast::cli::bench
