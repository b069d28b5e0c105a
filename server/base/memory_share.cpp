#include "server/base/memory_share.h"

#include <linux/magic.h>
#include <sys/vfs.h>

#include <algorithm>

#include "core/base/machine.h"
#include "core/base/spill.h"
#include "server/base/options.h"
#include "server/base/scratch_folder.h"

namespace curvecast::server {

std::uint64_t memory_share(const ServerOptions& options) {
  constexpr double kShare = 0.7;  // the rest is for others
  if (options.memory_bytes > 0) return options.memory_bytes;
  return static_cast<std::uint64_t>(kShare * static_cast<double>(machine_memory_bytes()));
}

std::uint64_t memory_with_file(const ServerOptions& options, std::uint64_t memory) {
  constexpr std::uint64_t kMostInFile = 1;  // times the memory
  constexpr double kShareOfDisk = 0.9;
  struct statfs disk {};
  if (::statfs(scratch_folder(options).c_str(), &disk) != 0) return memory;
  if (disk.f_type == TMPFS_MAGIC || disk.f_type == RAMFS_MAGIC) return memory;  // files there are memory as well
  const auto free = static_cast<std::uint64_t>(disk.f_bavail) * static_cast<std::uint64_t>(disk.f_bsize) + spill_usage().bytes;
  const auto file = static_cast<std::uint64_t>(kShareOfDisk * static_cast<double>(free));
  return memory + (has_other_clients(options) ? std::min(file, kMostInFile * memory) : file);
}

bool has_other_clients(const ServerOptions& options) { return !options.listen.empty() || !options.http.empty(); }

}  // namespace curvecast::server
