#include "client/cli/sibling_program.h"

#include <absl/strings/str_cat.h>
#include <unistd.h>

#include <filesystem>
#include <system_error>

namespace curvecast::cli {

absl::StatusOr<std::string> sibling_program(const std::string& name) {
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  if (error) return absl::NotFoundError(absl::StrCat(name, ": the folder of this program is unknown: ", error.message()));
  const std::string path = self.parent_path() / name;
  if (::access(path.c_str(), X_OK) != 0) return absl::NotFoundError(absl::StrCat(path, ": there is no such program"));
  return path;
}

}  // namespace curvecast::cli
