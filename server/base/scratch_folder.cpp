#include "server/base/scratch_folder.h"

#include <filesystem>
#include <system_error>

namespace curvecast::server {

std::string scratch_folder(const ServerOptions& options) {
  if (!options.cache.empty()) return options.cache;
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(error);
  return error ? std::string() : folder.string();
}

}  // namespace curvecast::server
