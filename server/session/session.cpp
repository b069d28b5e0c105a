#include "server/session/session.h"

#include <absl/strings/str_format.h>
#include <sys/resource.h>

#include "core/storage/pipeline_archive.h"
#include "server/base/hash.h"

namespace curvecast::server {

std::string session_id(const MeshFiles& files, const PreprocessOptions& options) {
  Hasher hasher;
  const std::string all_options = to_archive(options);
  hasher.update(absl::StrFormat("%d\n%s\n%d\n", kAlgorithmVersion, files.mesh->id, all_options.size()));
  hasher.update(all_options);
  for (const auto& [name, file] : files.companions) {
    hasher.update(absl::StrFormat("%d %s\n%s\n", name.size(), name, file->id));
  }
  return hasher.hex();
}

std::uint64_t peak_memory_bytes() {
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

}  // namespace curvecast::server
