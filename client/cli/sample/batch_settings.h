// What `batch` makes of a mesh: the flags of the command, and what a line of the list says otherwise.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "client/cli/common.h"
#include "client/cli/sample/manifest.h"
#include "client/cli/sample/mesh_sampling.h"

namespace curvecast::cli {

struct BatchSettings {
  SamplingFlags sampling = {.sample = {.points = 0}};  // 0: not said
  std::string format = "ply";                          // ending of the outputs, or "none": sessions only
  std::uint64_t seed = 0;

  bool has_points() const;
  /// Returns the name of an output; empty where there are no points.
  std::string output_of(const std::string& name) const;
};

/// Adds all of them but the seed; values are checked while parsing.
void add_batch_settings(CLI::App* command, BatchSettings* settings);

/// Reads the options of one mesh after the other. Not thread-safe.
class EntryOptions {
 public:
  /// `usual`: what holds where an entry says nothing.
  explicit EntryOptions(BatchSettings usual);
  ~EntryOptions();

  /// InvalidArgument: there is no such option, or not of such a value; nothing says how many points.
  absl::StatusOr<BatchSettings> of(const std::vector<std::string>& arguments);

 private:
  const BatchSettings usual_;
  BatchSettings settings_;  // that app_ fills
  const std::unique_ptr<CLI::App> app_;
};

/// A mesh and where what is made of it goes, beneath the folder of outputs.
struct PlannedMesh {
  std::string mesh, name;  // as in the list
  std::string path;        // of the mesh
  std::string output;      // empty: sessions only
  std::string record;      // of what was made, see batch_record.h
  std::vector<std::string> arguments;
};

/// Plans a list: paths of meshes are relative to `folder`. InvalidArgument names the line of an entry whose options are wrong,
/// whose output would be another one's too, or would replace a mesh of the list (`out`: folder of outputs).
absl::StatusOr<std::vector<PlannedMesh>> plan_batch(std::vector<ManifestEntry> entries, const std::string& folder,
                                                    const std::string& out, EntryOptions& options);

}  // namespace curvecast::cli
