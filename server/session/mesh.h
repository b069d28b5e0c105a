// A mesh file, or another file that meshes refer to.
#pragma once

#include <absl/status/statusor.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "core/base/execution_context.h"
#include "core/base/mutex.h"
#include "server/session/mesh_bytes.h"

namespace curvecast::server {

/// What is known of a file without its bytes.
struct MeshLabel {
  std::string id;           // hash of the bytes
  std::string name = {};    // as first uploaded
  std::string sender = {};  // whose share of the store it takes
  std::string realm = {};   // of those who may find it, 32 hexadecimal digits; empty: all may

  /// By which the file is looked up: the id, after the realm and a dash where there is one.
  std::string key() const { return realm.empty() ? id : realm + "-" + id; }
};

/// Thread-safe. What it says of the file never changes; the bytes of one on the disk are brought in when they are first needed.
class Mesh {
 public:
  /// Brings the bytes in. `is_known_good`: they have been compared with the id before. NotFound where they are not the file's: it
  /// is gone then.
  using Load = std::function<absl::StatusOr<MeshBytes>(bool is_known_good, const ExecutionContext& context)>;

  Mesh(MeshLabel label, MeshBytes bytes);
  Mesh(MeshLabel label, std::size_t size, Load load);

  // As of MeshLabel.
  const std::string id, name, sender, key;
  std::size_t size() const { return size_; }

  /// Has the bytes at hand from now on, checked. May read all of the file the first time: for workers. Errors of `load`, and of
  /// the context.
  absl::Status open(const ExecutionContext& context = {}) const ABSL_LOCKS_EXCLUDED(opening_, mutex_);
  /// Whether open() would have the whole file to read.
  bool is_checked() const ABSL_LOCKS_EXCLUDED(mutex_);
  /// Precondition: open() has succeeded. Valid as long as somebody besides the store holds the mesh.
  std::span<const char> bytes() const ABSL_LOCKS_EXCLUDED(mutex_);
  /// OK, or DataLoss where bytes that were at hand have gone: to be asked before what came of them is used.
  absl::Status status() const ABSL_LOCKS_EXCLUDED(mutex_);
  /// Lets go of what was read so far; it can be read again.
  void release_pages() const ABSL_LOCKS_EXCLUDED(mutex_);
  /// Puts the bytes back on the disk, if they are there. Precondition: nobody uses them.
  void close() const ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  const std::size_t size_;
  const Load load_;                                     // empty: the bytes are at hand, always
  mutable Mutex opening_ ABSL_ACQUIRED_BEFORE(mutex_);  // one loads, others wait
  mutable Mutex mutex_;
  mutable MeshBytes bytes_ ABSL_GUARDED_BY(mutex_);
  mutable bool is_open_ ABSL_GUARDED_BY(mutex_) = false;
  mutable bool is_checked_ ABSL_GUARDED_BY(mutex_) = false;
};

}  // namespace curvecast::server
