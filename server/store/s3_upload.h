// Puts a file into S3: in one request, or in parts where it is large.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/mutex.h"
#include "server/store/s3_client.h"

namespace curvecast::server {

/// The object's own metadata that says what was put.
inline constexpr char kSha256Header[] = "x-amz-meta-sha256";

/// A file to put, open for reading, and what its bytes come to.
struct S3File {
  int descriptor = -1;
  std::uint64_t size = 0;
  std::uint64_t part_size = 0;
  std::string sha256;
  std::vector<std::string> parts;  // SHA-256 of each
};

/// Reads all of a file once. Parts are of `least_part_size` bytes, or more where there would be more than S3 takes. Unavailable
/// where it cannot be read; and the deadline's errors.
absl::StatusOr<S3File> read_s3_file(int descriptor, std::uint64_t size, std::uint64_t least_part_size, const Deadline& deadline);

/// Thread-safe.
class S3Upload {
 public:
  explicit S3Upload(S3Client& client) : client_(client) {}

  /// S3 compares every byte with its hash. Where this fails the object is what it was, and no part is left: what cannot be taken
  /// back now, as the store is away, is when the next file has been put. Errors as of S3Client::send().
  absl::Status put(const std::string& key, const S3File& file, const Deadline& deadline);

 private:
  struct Id {
    std::string key, upload;
  };
  absl::Status put_whole(const std::string& key, const S3File& file, const Deadline& deadline);
  absl::Status put_parts(const std::string& key, const S3File& file, const Deadline& deadline);
  absl::StatusOr<std::string> begin(const std::string& key, const S3File& file, const Deadline& deadline);
  /// Returns its ETag.
  absl::StatusOr<std::string> put_part(const Id& id, const S3File& file, std::size_t part, const Deadline& deadline);
  absl::Status complete(const Id& id, const std::vector<std::string>& etags, const Deadline& deadline);
  bool is_stored(const std::string& key, const S3File& file, const Deadline& deadline);
  /// Removes what has come of an upload.
  absl::Status abort(const Id& id);
  void abort_lost() ABSL_LOCKS_EXCLUDED(mutex_);

  S3Client& client_;
  Mutex mutex_;
  std::vector<Id> lost_ ABSL_GUARDED_BY(mutex_);  // could not be aborted
};

}  // namespace curvecast::server
