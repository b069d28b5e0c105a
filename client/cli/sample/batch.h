// Makes one mesh of a list after the other into points and sessions, so that it can be killed at any moment and go on.
#pragma once

#include <absl/status/statusor.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "client/cli/common.h"
#include "client/cli/sample/batch_settings.h"
#include "client/cli/sample/mesh_sampling.h"
#include "client/cli/sample/shard.h"

namespace curvecast::cli {

struct BatchOptions {
  std::string out;  // folder of outputs and records, which is there
  Shard shard;      // of the plan
  bool fail_fast = false;
};

struct BatchTally {
  std::uint64_t meshes = 0;  // of the shard
  std::uint64_t made = 0, kept = 0, failed = 0;
  std::uint64_t points = 0;                        // of all outputs, made or kept
  absl::StatusCode worst = absl::StatusCode::kOk;  // of failures; one that is not the mesh's fault goes before others
};

/// Not thread-safe.
class Batch {
 public:
  Batch(const BatchOptions& batch, const CommonOptions& common, EntryOptions& entries)
      : batch_(batch), common_(common), entries_(entries) {}

  /// Makes what is not there yet of the shard; what is stays as it is. Tells of failures on standard error, and goes on with the
  /// next mesh. Returns an error, and keeps what is done: Cancelled; where a mesh has failed and fail_fast is set; where outputs
  /// cannot be written, or a server not be reached, which would be so for every mesh.
  absl::Status run(const std::vector<PlannedMesh>& plan, const std::stop_token& stop);

  const BatchTally& tally() const { return tally_; }
  /// After run(): a line of JSON for each mesh of the shard, in the order of the plan.
  const std::vector<Json>& lines() const { return lines_; }

 private:
  /// What is wanted of a mesh as it is now.
  struct Wanted {
    BatchSettings settings;
    Json settings_json;
    std::string sha256;
  };
  struct Made {
    Json record;
    client::Points points;  // to be written; none for sessions only
  };
  enum class Turn { kFirst, kLast };

  absl::StatusOr<Wanted> look_at(const PlannedMesh& mesh, const std::stop_token& stop);
  /// Whether what is wanted is there.
  absl::StatusOr<bool> is_current(const PlannedMesh& mesh, const Wanted& wanted, const Json& record,
                                  const std::stop_token& stop) const;
  absl::StatusOr<Made> make(const PlannedMesh& mesh, const Wanted& wanted, const std::string& title,
                            const std::stop_token& stop) const;
  /// Has the mesh's session made and, where they are wanted, takes points of it. May put another server in the place of `host`.
  absl::StatusOr<SampledMesh> sample_prepared(const PlannedMesh& mesh, const Wanted& wanted, const SamplingRequests& requests,
                                              std::unique_ptr<Host>& host, const client::StageProgress& on_progress,
                                              const std::stop_token& stop) const;
  absl::Status save(const PlannedMesh& mesh, const SamplingFlags& flags, Made& made) const;
  SessionCaching caching() const;
  bool is_cached(const std::string& session_id) const;
  /// Returns false, and has done nothing, where it is not the turn of the mesh. Errors as of run().
  absl::StatusOr<bool> work_on(const PlannedMesh& mesh, std::size_t position, Turn turn, const std::stop_token& stop);
  void note_done(std::size_t position, const Json& record);
  /// Returns true, or the error with which the run ends.
  absl::StatusOr<bool> note_failure(const PlannedMesh& mesh, std::size_t position, const absl::Status& status);
  std::string path_of(const std::string& name) const { return batch_.out + "/" + name; }

  const BatchOptions& batch_;
  const CommonOptions& common_;
  EntryOptions& entries_;
  BatchTally tally_;
  std::vector<Json> lines_;
};

}  // namespace curvecast::cli
