// Whole files that servers share, in a place that outlives each of them.
#pragma once

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

namespace curvecast::server {

/// Whole files by name, such as "sessions/ID.v7.curve" and "meshes/KEY": parts of letters, digits, '.', '-' and '_', with slashes
/// between them. Thread-safe. Calls wait for disk or network, each for a bounded time, and end early with Cancelled once `cancel`
/// is set, which may be null. Other errors than those named here: ResourceExhausted: the store is full; PermissionDenied: it does
/// not let this server in; DataLoss: what it gives is not what it says it has; Unavailable: what may pass by itself, such as a
/// network that is away. What is in the store is not trusted: who gets a file checks it.
class Store {
 public:
  virtual ~Store() = default;

  /// Puts the file at `path` under a name, whole or not at all, instead of what is there. Durable when it returns OK. NotFound
  /// where there is no file at `path`.
  virtual absl::Status put(const std::string& name, const std::string& path, const std::atomic<bool>* cancel) = 0;
  /// Gets a file into `path`, which appears whole or not at all, instead of what is there; not durable, for it can be got again.
  /// NotFound where the store has none.
  virtual absl::Status get(const std::string& name, const std::string& path, const std::atomic<bool>* cancel) = 0;
  /// Bytes of a file. NotFound where the store has none.
  virtual absl::StatusOr<std::uint64_t> size(const std::string& name, const std::atomic<bool>* cancel) = 0;
  /// Removes a file; OK where there is none.
  virtual absl::Status remove(const std::string& name, const std::atomic<bool>* cancel) = 0;
};

/// The store of a URL: "file:///DIR", a folder that all servers mount, or "s3://BUCKET/PREFIX". InvalidArgument for others;
/// FailedPrecondition where it cannot be used as things are set up.
absl::StatusOr<std::unique_ptr<Store>> open_store(const std::string& url);

/// Whether a name is one of Store's.
bool is_store_name(const std::string& name);

}  // namespace curvecast::server
