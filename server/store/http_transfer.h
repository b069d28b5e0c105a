// HTTP requests by libcurl, which signs them as S3 wants it.
#pragma once

#include <absl/status/statusor.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/mutex.h"

namespace curvecast::server {

/// What a request is signed with: AWS Signature Version 4 for the service "s3".
struct HttpSignature {
  std::string access_key, secret, region;
};

struct HttpRequest {
  std::string method = "GET";  // or HEAD, PUT, POST, DELETE
  /// Percent-encoded, which libcurl leaves to us as it signs what it is given. Parameters are in the order of their names, each
  /// with a '=', even without a value.
  std::string url;
  /// "name: value", none without a value. All of them are signed; "x-amz-content-sha256" has to be there then.
  std::vector<std::string> headers;
  const HttpSignature* signature = nullptr;  // null: not signed
  std::string body;                          // of a POST
  /// Of a PUT: bytes of a file that is open for reading.
  int file = -1;
  std::uint64_t offset = 0, size = 0;
};

struct HttpResponse {
  int status = 0;
  std::map<std::string, std::string> headers;  // by name in lower case
  std::string body;                            // what HttpHooks::take did not take; at most 64 KiB

  /// Empty where it is missing.
  std::string header(const std::string& name) const;
};

/// May be empty. An error of theirs ends the request, and is its result.
struct HttpHooks {
  /// Takes the next bytes of a response of success (2xx), whose status and headers are there.
  std::function<absl::Status(const HttpResponse& head, std::string_view bytes)> take;
  /// Called at least once a second.
  std::function<absl::Status()> check;
};

struct HttpOptions {
  std::string ca_bundle;  // file of certificates; empty: the system's
  std::chrono::milliseconds connect_timeout{5000};
  std::chrono::seconds stall_timeout{20};  // without a kilobyte a second
};

/// Thread-safe. Connections are kept for later requests, of whichever thread. Follows no redirection.
class HttpTransfer {
 public:
  explicit HttpTransfer(HttpOptions options);
  HttpTransfer(const HttpTransfer&) = delete;
  HttpTransfer& operator=(const HttpTransfer&) = delete;
  ~HttpTransfer();

  /// Returns the response, whatever its status. Unavailable where there is none: the error says why, and nothing of the keys. Has
  /// no limit of time but for connections and stalls: that is for hooks.check.
  absl::StatusOr<HttpResponse> run(const HttpRequest& request, const HttpHooks& hooks = {}) ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  struct Free {
    void operator()(void* handle) const;
  };
  using Handle = std::unique_ptr<void, Free>;  // of libcurl, with its connection
  Handle take_handle() ABSL_LOCKS_EXCLUDED(mutex_);
  void give_back(Handle handle) ABSL_LOCKS_EXCLUDED(mutex_);

  const HttpOptions options_;
  Mutex mutex_;
  std::vector<Handle> idle_ ABSL_GUARDED_BY(mutex_);
};

/// All but letters, digits, '-', '.', '_' and '~' as %XX.
std::string percent_encoded(const std::string& text);

}  // namespace curvecast::server
