// SPDX-License-Identifier: Apache-2.0
// The viewer's built files, in the binary.
#pragma once

#include <span>

#include "server/base/web_file.h"

namespace curvecast::web {

/// By path; empty where it was built without the viewer.
std::span<const server::WebFile> viewer_files();

}  // namespace curvecast::web
