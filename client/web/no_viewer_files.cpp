// SPDX-License-Identifier: Apache-2.0
#include "client/web/viewer_files.h"

namespace curvecast::web {

std::span<const server::WebFile> viewer_files() { return {}; }

}  // namespace curvecast::web
