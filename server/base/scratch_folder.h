// Where a server keeps what it needs for a while.
#pragma once

#include <string>

#include "server/base/options.h"

namespace curvecast::server {

/// The cache's folder; without a cache that for temporary files ($TMPDIR or /tmp), or "" where there is none.
std::string scratch_folder(const ServerOptions& options);

}  // namespace curvecast::server
