// Lists of meshes: what `batch` works on.
#pragma once

#include <absl/status/statusor.h>

#include <cstddef>
#include <istream>
#include <string>
#include <vector>

namespace curvecast::cli {

/// One mesh of a list.
struct ManifestEntry {
  std::size_t line = 0;                // of the list, from 1
  std::string mesh;                    // path, as it stands there
  std::string name;                    // of what is made of it: a relative path without an ending, such as "a/bunny"
  std::vector<std::string> arguments;  // options of this mesh alone, as of a command: "--points=1000"
};

/// Reads a list. Each line is the path of a mesh, or a JSON object: {"mesh": path, "name": ..., OPTION: value, ...}, where OPTION
/// is the long name of a flag, with - or _, and its value a string, a number, true or false, or an array of these. Without a name
/// it is the path without root and ending. Empty lines, and those that begin with #, are left out. InvalidArgument names the
/// line.
absl::StatusOr<std::vector<ManifestEntry>> parse_manifest(std::istream& in);

/// The same of a file, or of standard input ("-"). NotFound, InvalidArgument; messages begin with the path.
absl::StatusOr<std::vector<ManifestEntry>> read_manifest(const std::string& path);

/// OK for a path that cannot lead out of a folder: relative, in its shortest form, with a name at the end.
absl::Status check_output_name(const std::string& name);

}  // namespace curvecast::cli
