// What a mesh was made into, told by a small file beside the output. It says whether that is still what is wanted.
#pragma once

#include <absl/status/statusor.h>

#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "client/cli/common.h"
#include "client/cli/sample/batch_settings.h"

namespace curvecast::cli {

/// Returns the JSON object of a record; nothing where there is none that can be read.
std::optional<Json> read_record(const std::string& path);
/// Replaces the record, durably. Errors as of client::write_bytes.
absl::Status write_record(const std::string& path, const Json& record);

/// A record that stands while a mesh is being made into something. Where it still does later, that ended the process, perhaps.
Json record_of_making(const PlannedMesh& mesh);
bool is_of_making(const Json& record);

/// Returns all of the settings that an output depends on, and the version of the program.
absl::StatusOr<Json> settings_json(const BatchSettings& settings);
/// Adds to a record what the output depends on besides the mesh: settings, and the files that the mesh refers to.
void add_terms(const Json& settings, const client::UploadedMesh& mesh, Json* record);
/// Whether a record is of a mesh with this SHA-256 and these settings, and the files that it refers to are what they were, those
/// that were missing too. Errors: Cancelled, or such a file cannot be read.
absl::StatusOr<bool> has_terms(const Json& record, const std::string& mesh, const std::string& sha256, const Json& settings,
                               const std::stop_token& stop);

/// Returns what an index says of a mesh: its record without these terms.
Json index_line(const Json& record);
/// Returns JSON Lines.
std::string to_lines(const std::vector<Json>& records);

}  // namespace curvecast::cli
