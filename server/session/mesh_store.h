// The mesh files that clients have sent, named by their content.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <list>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>

#include "core/base/mutex.h"
#include "server/base/hash.h"
#include "server/session/mesh.h"
#include "server/session/mesh_bytes.h"
#include "server/session/mesh_folder.h"

namespace curvecast::server {

/// The beginning of a file whose upload is under way or broke off.
struct MeshPart {
  std::string name;
  GrowingBytes data;
  Hasher hasher;
  std::string expected_id;     // empty: not known beforehand
  std::uint64_t claimed = 0;   // bytes of the whole
  std::uint64_t reserved = 0;  // bytes of the store's budget: the data's capacity and a fixed charge
};

/// Thread-safe. Holds whole files, uploads under way, and the beginnings of uploads that broke off, within one budget: for room,
/// beginnings go first, then the least recently used files to which there are no references.
class MeshStore {
 public:
  /// Holds at most `max_bytes` of all files together, and takes files of at most `max_file_bytes`. They are kept in `folder`,
  /// without names; where that is empty or cannot be used, in memory.
  MeshStore(std::uint64_t max_bytes, std::uint64_t max_file_bytes, std::string folder = {});
  /// The same with files that survive: what other stores, or one before, have kept there is held here too. `kept` may be null:
  /// then as with `folder`.
  MeshStore(std::uint64_t max_bytes, std::uint64_t max_file_bytes, std::string folder, std::unique_ptr<MeshFolder> kept);

  /// Finds a file by its hash, whose bytes may still have to be brought in: see Mesh::open(). NotFound says what to do.
  absl::StatusOr<std::shared_ptr<const Mesh>> find(const std::string& id);
  /// How many bytes are there of the file with this hash, whose upload broke off.
  std::uint64_t received(const std::string& id);

  std::uint64_t max_file_bytes() const { return max_file_bytes_; }

  struct Usage {
    std::size_t meshes = 0;
    std::uint64_t bytes = 0;  // of the meshes and of uploads under way
  };
  Usage usage() const;
  /// Puts the bytes of files that nobody uses back on the disk. To be called now and then.
  void run_housekeeping();

 private:
  friend class MeshUpload;
  using Recency = std::list<std::shared_ptr<const Mesh>>;  // most recently used first

  /// Takes a mesh up that is in the folder.
  void adopt(std::shared_ptr<const Mesh> mesh) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  /// Forgets a mesh; its file stays. Returns what follows it.
  Recency::iterator drop(Recency::iterator mesh) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  /// Takes up what others have stored or removed, and how recently they have used it.
  void look_into_folder() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  absl::Status reserve(std::uint64_t bytes);
  void release(std::uint64_t bytes);
  std::shared_ptr<const Mesh> keep(std::shared_ptr<const Mesh> mesh, std::uint64_t reserved);
  /// Keeps a part for a later upload, instead of any other part of the same file.
  void park(MeshPart part);
  /// A part of which `offset` bytes have come, of a file of `size` bytes. FailedPrecondition where there is none.
  absl::StatusOr<MeshPart> resume(const std::string& id, std::uint64_t size, std::uint64_t offset);

  const std::uint64_t max_bytes_;
  const std::uint64_t max_file_bytes_;
  const std::string folder_;
  const std::unique_ptr<MeshFolder> kept_;  // null: no file survives
  mutable Mutex mutex_;
  std::uint64_t used_ ABSL_GUARDED_BY(mutex_) = 0;  // bytes of `recency_` and of all uploads
  Recency recency_ ABSL_GUARDED_BY(mutex_);
  std::unordered_map<std::string, Recency::iterator> by_id_ ABSL_GUARDED_BY(mutex_);
  std::list<MeshPart> parked_ ABSL_GUARDED_BY(mutex_);  // the newest first; within used_ too
};

/// One file on its way into the store, which must outlive it. Not thread-safe.
class MeshUpload {
 public:
  explicit MeshUpload(MeshStore& store) : store_(store) {}
  ~MeshUpload();  // keeps an unfinished file for another upload if the file's hash is known
  MeshUpload(const MeshUpload&) = delete;
  MeshUpload& operator=(const MeshUpload&) = delete;

  /// Begins a file of `size` bytes, which the client claims: it is checked, never allocated ahead. `expected_id` is the file's
  /// hash; empty: not known. Above 0, `offset` resumes an upload that broke off: FailedPrecondition where it is not
  /// MeshStore::received(expected_id). ResourceExhausted where there is no room; InvalidArgument for the rest.
  absl::Status begin(std::string_view name, std::uint64_t size, std::string_view expected_id, std::uint64_t offset = 0);
  /// Takes the next bytes. InvalidArgument where there are more than announced; ResourceExhausted where there is no room.
  absl::Status append(std::string_view chunk);
  /// Stores the file, and returns it or the one already held for the same bytes. Where files survive, this one does from now on,
  /// and the call waits for the disk. InvalidArgument for a wrong size or hash; ResourceExhausted and Unavailable where it cannot
  /// be stored.
  absl::StatusOr<std::shared_ptr<const Mesh>> finish();

 private:
  MeshStore& store_;
  MeshPart part_;
  bool is_sound_ = true;  // no more bytes came than there should
};

}  // namespace curvecast::server
