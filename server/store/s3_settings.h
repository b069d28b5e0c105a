// Where a bucket is and with which keys, from the environment and the files that the AWS command line reads.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "core/base/mutex.h"

namespace curvecast::server {

/// The value of an environment variable; empty where it is not set.
using Environment = std::function<std::string(const std::string& name)>;
Environment process_environment();

struct S3Endpoint {
  std::string url;  // of the bucket, percent-encoded, without a '/' at its end
  std::string region;
  std::string ca_bundle;  // file of certificates; empty: the system's
};

/// AWS_ENDPOINT_URL_S3 or AWS_ENDPOINT_URL, AWS_REGION or AWS_DEFAULT_REGION, else endpoint_url and region of the profile
/// (AWS_PROFILE, "default") in AWS_CONFIG_FILE (~/.aws/config), else AWS in us-east-1; AWS_CA_BUNDLE. A bucket of AWS is in the
/// host's name ("https://BUCKET.s3.REGION.amazonaws.com"), one of an endpoint in the path. InvalidArgument where that is no
/// bucket's name; FailedPrecondition says which setting cannot be used.
absl::StatusOr<S3Endpoint> find_s3_endpoint(const std::string& bucket, const Environment& environment);

struct S3Keys {
  std::string access_key, secret, session_token;  // the last one may be empty
  bool operator==(const S3Keys&) const = default;
};

/// AWS_ACCESS_KEY_ID, AWS_SECRET_ACCESS_KEY and AWS_SESSION_TOKEN, or else aws_access_key_id and so on of the profile
/// (AWS_PROFILE, "default") in AWS_SHARED_CREDENTIALS_FILE (~/.aws/credentials), which is read anew when it changes. Thread-safe.
class S3KeySource {
 public:
  /// FailedPrecondition where there are no keys: says where they were looked for, and nothing of what was found.
  static absl::StatusOr<std::unique_ptr<S3KeySource>> open(const Environment& environment);

  /// The newest keys. A file that cannot be used any more leaves those that there were.
  S3Keys keys() ABSL_LOCKS_EXCLUDED(mutex_);
  /// Keys that have been refused: reads the file, even if it seems to be the same. Others, where there are.
  std::optional<S3Keys> keys_instead_of(const S3Keys& refused) ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  /// What tells a file from another of the same name.
  struct Version {
    std::int64_t seconds = 0, nanoseconds = 0;
    std::uint64_t inode = 0, size = 0;
    bool operator==(const Version&) const = default;
  };
  S3KeySource(std::string file, std::string profile) : file_(std::move(file)), profile_(std::move(profile)) {}
  absl::Status read() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  static std::optional<Version> version_of(const std::string& file);

  const std::string file_, profile_;  // no file: the keys are from the environment
  Mutex mutex_;
  S3Keys keys_ ABSL_GUARDED_BY(mutex_);
  std::optional<Version> version_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace curvecast::server
