// SPDX-License-Identifier: Apache-2.0
// Zip archives in memory, whose entries lie in them as they are.
#pragma once

#include <absl/status/statusor.h>

#include <string>
#include <vector>

namespace curvecast::formats {

struct ZipEntry {
  std::string name, bytes;
};

/// Returns an archive of the entries, in their order, uncompressed; entries are of 1980-01-01, so that the same entries are the same
/// bytes. InvalidArgument: two entries of one name. ResourceExhausted: not enough memory.
absl::StatusOr<std::string> make_zip_archive(const std::vector<ZipEntry>& entries);

}  // namespace curvecast::formats
