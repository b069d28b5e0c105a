// SPDX-License-Identifier: Apache-2.0
// Names of a mesh's numbers in files.
#pragma once

#include <absl/strings/ascii.h>

#include <string>
#include <string_view>

namespace curvecast::formats {

/// A name comes from a mesh, by way of a server: returns it without blanks, control characters, letters beyond ASCII, and what would
/// make a path of it; "_" stands for each of their bytes.
inline std::string column_name(std::string_view name) {
  std::string out;
  for (const char c : name) {
    out += absl::ascii_isgraph(static_cast<unsigned char>(c)) && c != '/' && c != '\\' && c != ':' ? c : '_';
  }
  return out;
}

}  // namespace curvecast::formats
