// Requests to one bucket, signed with the newest keys, and tried again where that helps.
#pragma once

#include <absl/status/statusor.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "server/store/deadline.h"
#include "server/store/http_transfer.h"
#include "server/store/s3_settings.h"

namespace curvecast::server {

struct S3Options {
  HttpOptions http;
  int tries = 5;                              // of a request, as long as it brings nothing
  std::chrono::milliseconds first_wait{200};  // before the second try; twice as long each time
  std::chrono::milliseconds longest_wait{5000};
  std::chrono::seconds time{60};                      // of a call, and as long as `rate` takes for its bytes
  std::uint64_t rate = std::uint64_t{1} << 20;        // bytes a second
  std::uint64_t part_size = std::uint64_t{16} << 20;  // bytes; larger files are put in parts, of which S3 takes 10,000
};

struct S3Request {
  std::string method;
  std::string key;    // of the object, as it is
  std::string query;  // as in HttpRequest::url
  std::vector<std::string> headers;
  std::string body;  // of a POST
  int file = -1;     // of a PUT: see HttpRequest
  std::uint64_t offset = 0, size = 0;
  std::string sha256;  // of these bytes, hexadecimal
  std::function<absl::Status(const HttpResponse& head, std::string_view bytes)> take = {};
};

/// When to try again.
class S3Retry {
 public:
  S3Retry(const S3Options& options, const Deadline& deadline);
  /// After a try that failed: waits, with jitter, and returns OK where it is worth another one. Else what the whole call returns.
  absl::Status after(const absl::Status& failure);
  /// The last try brought something: the next ones count, and wait, as the first ones.
  void reset();

 private:
  const S3Options& options_;
  const Deadline& deadline_;
  const std::uint64_t seed_;
  int tries_ = 0;
  std::uint64_t waits_ = 0;
  std::chrono::milliseconds wait_;
};

/// Thread-safe.
class S3Client {
 public:
  S3Client(std::string bucket, S3Endpoint endpoint, std::unique_ptr<S3KeySource> keys, S3Options options);

  const S3Options& options() const { return options_; }
  /// What errors call an object.
  std::string name_of(const std::string& key) const;

  /// One request, once more with other keys where there are others than those that were refused. Errors as of s3_error() and of
  /// `take`, and Unavailable where no response comes before the deadline.
  absl::StatusOr<HttpResponse> send_once(const S3Request& request, const Deadline& deadline);
  /// The same, again while that may help.
  absl::StatusOr<HttpResponse> send(const S3Request& request, const Deadline& deadline);

 private:
  absl::StatusOr<HttpResponse> send_with(const S3Keys& keys, const S3Request& request, const Deadline& deadline);

  const std::string bucket_;
  const S3Endpoint endpoint_;
  const S3Options options_;
  const std::unique_ptr<S3KeySource> keys_;
  HttpTransfer transfer_;
};

}  // namespace curvecast::server
