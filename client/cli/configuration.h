// A command's options from a file and from the environment.
#pragma once

#include <absl/status/statusor.h>

#include <string>
#include <vector>

namespace CLI {  // its header has globals that every source would compile anew
class App;
}

namespace curvecast::cli {

/// One option, and where its value came from.
struct Setting {
  std::string name;   // without dashes
  std::string value;  // as text
  std::string source;
};

/// The variable that stands for an option: CURVECAST_MAX_UPLOAD for max-upload.
std::string environment_name(const std::string& option);

/// Gives a value to each configurable option of a command that has been parsed and has none: from the environment, or else from
/// the file (TOML without tables; empty: none). An empty text counts as none; one for an option that takes several values
/// separates them by semicolons. Returns all settings by name. InvalidArgument names what is wrong where, every unknown key at
/// once; errors of reading as of client::read_bytes().
absl::StatusOr<std::vector<Setting>> configure(CLI::App& command, const std::string& file);

/// All settings as such a file.
std::string to_configuration(const CLI::App& command);

}  // namespace curvecast::cli
