// SPDX-License-Identifier: Apache-2.0
// Names of a mesh's numbers in the headers of PLY files.
#pragma once

#include <absl/strings/ascii.h>

#include <string>
#include <string_view>

namespace curvecast::formats {

/// A name comes from a mesh, by way of a server: nothing in it may end a word of the header.
inline std::string ply_name(std::string_view name) {
  std::string out;
  for (const char c : name) out += absl::ascii_isgraph(static_cast<unsigned char>(c)) ? c : '_';
  return out;
}

}  // namespace curvecast::formats
