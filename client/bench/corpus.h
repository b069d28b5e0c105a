// Takes every mesh file of a folder through the whole of preprocessing and checks what comes out.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "client/bench/bench_report.h"
#include "core/pipeline/pipeline.h"

namespace curvecast::cli::bench {

struct CorpusOptions {
  std::uint64_t points = 20'000;  // N of the curve and of the uniform sample, 1 .. kMaxPoints
  std::uint64_t seed = 0;         // of the sample
};

enum class Verdict {
  kPassed,
  kFailed,   // came through, but not as it should: see the message
  kRefused,  // an error
  kNothing,  // the file holds no triangle with an area: nothing to sample
};

struct CorpusEntry {
  std::string name;  // path within the folder
  Verdict verdict = Verdict::kRefused;
  std::string message = {};      // empty when passed
  PreprocessReport report = {};  // when passed or failed, as is what follows
  double area_error = 0;         // |sum of the parameter meshes' areas on the surface / area of the repaired mesh - 1|
  double sample_distance = 0;    // largest distance of a sample from the face that it says it lies on, in box diagonals
  double seconds = 0;            // of everything
  std::uint64_t peak_bytes = 0;  // of the whole process while it worked on this file; 0 = not measured
};

/// Mesh files in the folder and below, by their endings, in ascending order; paths relative to it. NotFound for no folder.
absl::StatusOr<std::vector<std::string>> find_meshes(const std::string& folder);

/// One file. Passed: no flipped triangle, area_error at most 1e-9, area elements that add up to 1e-9, all of N samples, and none
/// of them farther from its face than its coordinates' rounding to floats. Errors and exceptions are in the entry, never thrown.
CorpusEntry examine_mesh(const std::string& folder, const std::string& name, const CorpusOptions& options,
                         const ExecutionContext& context);

/// All of them, each handed to `on_entry` when it is done. Cancelled.
absl::StatusOr<std::vector<CorpusEntry>> run_corpus(const std::string& folder, const CorpusOptions& options,
                                                    const ExecutionContext& context,
                                                    const std::function<void(const CorpusEntry&)>& on_entry = {});

/// Counts by verdict, and the worst values of those that came through.
BenchReport summarise_corpus(const std::vector<CorpusEntry>& entries);
/// No file was refused or failed.
bool corpus_passed(const std::vector<CorpusEntry>& entries);

}  // namespace curvecast::cli::bench
