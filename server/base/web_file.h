// SPDX-License-Identifier: Apache-2.0
// A file that the HTTP port serves.
#pragma once

#include <string_view>

namespace curvecast::server {

/// In memory for as long as the process lives.
struct WebFile {
  std::string_view path;          // "/assets/viewer.js"
  std::string_view type;          // as in Content-Type
  std::string_view gzip;          // its bytes, compressed
  bool is_immutable;              // never changes under this name: its name has a hash in it
  std::string_view scripts = {};  // of a page: the scripts within it that may run, as in Content-Security-Policy: "'sha256-...'"
};

}  // namespace curvecast::server
