// A store in a folder that all servers mount: on this machine, or by NFS, CephFS and the like. Files are copied, never mapped.
#pragma once

#include <absl/status/statusor.h>

#include <chrono>
#include <memory>
#include <string>

#include "server/store/store.h"

namespace curvecast::server {

/// What the system does not answer for so long is given up.
inline constexpr std::chrono::milliseconds kFilePatience = std::chrono::seconds(15);

/// The folder, an absolute path, has to be there, but need not be now: calls are Unavailable as long as it is not, or does not
/// answer. A file becomes another's by a name of its own and a rename, so that readers on other machines see whole ones; those
/// half-written are in its folder "tmp", and those of servers that were killed are removed from there. InvalidArgument where the
/// path is not absolute.
absl::StatusOr<std::unique_ptr<Store>> make_file_store(const std::string& folder,
                                                       std::chrono::milliseconds patience = kFilePatience);

}  // namespace curvecast::server
