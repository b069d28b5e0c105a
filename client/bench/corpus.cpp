#include "client/bench/corpus.h"

#include <absl/strings/ascii.h>
#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include <algorithm>
#include <array>
#include <exception>
#include <filesystem>
#include <limits>
#include <system_error>
#include <utility>

#include "client/bench/local_mesh.h"
#include "client/bench/peak_memory.h"
#include "core/base/stopwatch.h"
#include "core/mesh/triangle_distance.h"
#include "core/mesh_io/mesh_io.h"
#include "core/sample/resample.h"

namespace curvecast::cli::bench {
namespace {

constexpr std::array<const char*, 7> kEndings = {".ply", ".obj", ".off", ".stl", ".gltf", ".glb", ".3mf"};
constexpr double kMaxAreaError = 1e-9;
constexpr double kMaxElementError = 1e-9;

/// Area of all charts' triangles on the surface.
double chart_area(const std::vector<Chart>& charts) {
  double sum = 0;
  for (const Chart& chart : charts) {
    for (std::size_t t = 0; t < chart.disc.face_count(); ++t) {
      sum += area_ratio({chart.disc, chart.uv}, t) * uv_area({chart.disc, chart.uv}, t);
    }
  }
  return sum;
}

double sample_distance(const TriangleMesh& mesh, const SurfaceCurve& curve, const PointSet& points) {
  double largest = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Triangle& t = mesh.triangles[curve.triangle[points.vertices[i]]];
    const Vec3d p = points.origin + points.positions[i].cast<double>();
    largest = std::max(largest, triangle_distance(p, mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]));
  }
  return largest;
}

/// Whether an error of preprocessing says that there is no triangle with an area. Both readers and repair say so in words only.
bool is_nothing(const absl::Status& status) {
  return absl::IsInvalidArgument(status) && (absl::StrContains(status.message(), "no faces: none of its polygons") ||
                                             absl::StrContains(status.message(), "the mesh has no face with an area"));
}

absl::Status examine(const std::string& path, const CorpusOptions& options, const ExecutionContext& context, CorpusEntry& entry) {
  absl::StatusOr<LocalMesh> local = LocalMesh::read(path);
  if (!local.ok()) return local.status();
  const PreprocessOptions preprocess_options{.points = options.points};
  const absl::StatusOr<Preprocessed> preprocessed = preprocess(local->file(entry.name), preprocess_options, context);
  if (!preprocessed.ok()) return preprocessed.status();
  const FlattenedMesh& flattened = *preprocessed->flattened;
  const absl::StatusOr<PointSet> points =
      resample(*preprocessed->curve, {.points = options.points, .density = {}, .seed = options.seed});
  if (!points.ok()) return points.status();

  entry.report = preprocessed->report;
  const MeshInfo& mesh = entry.report.mesh;
  entry.area_error = std::abs(chart_area(flattened.charts) / mesh.area - 1);
  entry.sample_distance = sample_distance(flattened.loaded.mesh, *preprocessed->curve, *points) / mesh.box.diagonal();
  // Half a unit in the last place for each coordinate; twice that is allowed.
  const Vec3d reach = (mesh.box.max - points->origin).cwiseAbs().cwiseMax((mesh.box.min - points->origin).cwiseAbs());
  const double rounding = reach.norm() * std::numeric_limits<float>::epsilon() / mesh.box.diagonal();

  std::vector<std::string> faults;
  if (entry.report.flipped_triangles > 0) faults.push_back(absl::StrCat(entry.report.flipped_triangles, " flipped triangles"));
  if (!(entry.area_error <= kMaxAreaError)) faults.push_back(absl::StrFormat("area off by %.1e", entry.area_error));
  if (!(entry.report.area_error <= kMaxElementError)) {
    faults.push_back(absl::StrFormat("area elements off by %.1e", entry.report.area_error));
  }
  if (points->size() != options.points) faults.push_back(absl::StrCat(points->size(), " samples"));
  if (!(entry.sample_distance <= rounding)) {
    faults.push_back(absl::StrFormat("a sample %.1e box diagonals off its face", entry.sample_distance));
  }
  entry.verdict = faults.empty() ? Verdict::kPassed : Verdict::kFailed;
  for (const std::string& fault : faults) absl::StrAppend(&entry.message, entry.message.empty() ? "" : ", ", fault);
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::vector<std::string>> find_meshes(const std::string& folder) {
  namespace fs = std::filesystem;
  std::error_code error;
  fs::recursive_directory_iterator files(folder, fs::directory_options::skip_permission_denied, error);
  if (error) return absl::NotFoundError(absl::StrCat(folder, ": ", error.message()));
  std::vector<std::string> names;
  for (; files != fs::recursive_directory_iterator(); files.increment(error)) {
    if (error) return absl::NotFoundError(absl::StrCat(folder, ": ", error.message()));
    const std::string ending = absl::AsciiStrToLower(files->path().extension().string());
    const bool known = std::find(kEndings.begin(), kEndings.end(), ending) != kEndings.end();
    if (known && files->is_regular_file(error)) names.push_back(files->path().lexically_relative(folder).string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

CorpusEntry examine_mesh(const std::string& folder, const std::string& name, const CorpusOptions& options,
                         const ExecutionContext& context) {
  CorpusEntry entry{.name = name};
  Stopwatch watch;
  const bool counts_memory = reset_peak_memory();
  absl::Status status;
  try {
    status = examine((std::filesystem::path(folder) / name).string(), options, context, entry);
  } catch (const std::exception& error) {
    status = absl::InternalError(absl::StrCat("unexpected: ", error.what()));
  }
  if (!status.ok()) {
    entry.verdict = is_nothing(status) ? Verdict::kNothing : Verdict::kRefused;
    entry.message = std::string(status.message());
  }
  entry.seconds = watch.lap();
  if (counts_memory) entry.peak_bytes = peak_memory();
  return entry;
}

absl::StatusOr<std::vector<CorpusEntry>> run_corpus(const std::string& folder, const CorpusOptions& options,
                                                    const ExecutionContext& context,
                                                    const std::function<void(const CorpusEntry&)>& on_entry) {
  const absl::StatusOr<std::vector<std::string>> names = find_meshes(folder);
  if (!names.ok()) return names.status();
  std::vector<CorpusEntry> entries;
  for (const std::string& name : *names) {
    context.progress(name, static_cast<double>(entries.size()) / static_cast<double>(names->size()));
    ExecutionContext silent = context;
    silent.on_progress = nullptr;
    CorpusEntry entry = examine_mesh(folder, name, options, silent);
    if (absl::Status status = context.check(); !status.ok()) return status;
    if (on_entry) on_entry(entry);
    entries.push_back(std::move(entry));
  }
  return entries;
}

BenchReport summarise_corpus(const std::vector<CorpusEntry>& entries) {
  std::array<std::size_t, 4> counts{};
  std::uint64_t flipped = 0;
  double area = 0, elements = 0, distance = 0, distortion = 0, seconds = 0, total = 0;
  std::uint32_t level = 0;
  for (const CorpusEntry& entry : entries) {
    ++counts[static_cast<std::size_t>(entry.verdict)];
    total += entry.seconds;
    if (entry.verdict == Verdict::kRefused || entry.verdict == Verdict::kNothing) continue;
    flipped += entry.report.flipped_triangles;
    area = std::max(area, entry.area_error);
    elements = std::max(elements, entry.report.area_error);
    distance = std::max(distance, entry.sample_distance);
    distortion = std::max(distortion, entry.report.distortion.max);
    level = std::max(level, entry.report.max_level);
    seconds = std::max(seconds, entry.seconds);
  }
  const auto count = [&](Verdict verdict) { return static_cast<double>(counts[static_cast<std::size_t>(verdict)]); };
  return {"corpus",
          {{"files", static_cast<double>(entries.size()), "files"},
           {"passed", count(Verdict::kPassed), "files"},
           {"failed", count(Verdict::kFailed), "files"},
           {"refused", count(Verdict::kRefused), "files"},
           {"nothing to sample", count(Verdict::kNothing), "files"},
           {"flipped triangles", static_cast<double>(flipped), "triangles"},
           {"worst area error", area, "relative"},
           {"worst area element error", elements, "relative"},
           {"worst sample distance", distance, "diagonals"},
           {"worst distortion", distortion, "ratio"},
           {"deepest quadtree level", static_cast<double>(level), "levels"},
           {"slowest file", seconds, "s"},
           {"all files", total, "s"}}};
}

bool corpus_passed(const std::vector<CorpusEntry>& entries) {
  return std::all_of(entries.begin(), entries.end(), [](const CorpusEntry& entry) {
    return entry.verdict == Verdict::kPassed || entry.verdict == Verdict::kNothing;
  });
}

}  // namespace curvecast::cli::bench
