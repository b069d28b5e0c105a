// The mesh files that survive the server: a folder in that of the cache, with a file KEY.mesh for each. That holds the mesh
// file's bytes, then its name, who sent it, and a trailer that says how long these are. Behind it there may be a store that
// servers share, with the same files: "meshes/KEY".
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/storage/atomic_file.h"
#include "server/session/mesh.h"
#include "server/store/watched_store.h"

namespace spdlog {
class logger;
}

namespace curvecast::server {

/// Thread-safe. Several processes may share a folder: files appear and go whole, and whoever has one open keeps it.
class MeshFolder {
 public:
  /// Makes the folder in that of the cache, if it is missing, and removes what killed processes left half-written.
  /// FailedPrecondition where it cannot be used. `store`, which may be null, must outlive it.
  static absl::StatusOr<std::unique_ptr<MeshFolder>> open(const std::string& cache, std::shared_ptr<spdlog::logger> log,
                                                          WatchedStore* store = nullptr);

  /// Whether there is a store.
  bool is_shared() const { return store_ != nullptr; }
  /// OK, or Unavailable where the store is away, so that store() would be, too.
  absl::Status may_store() const;

  /// A file to write a mesh's bytes to, for store(). ResourceExhausted: the disk is full; Unavailable for all else.
  absl::StatusOr<AtomicFile> create() const;
  /// Makes a file with a mesh's bytes durable under the mesh's key, and returns the mesh. What is there of that key is replaced.
  /// Waits for the disk, and until the store has it. Errors as of create(); then nothing is kept.
  absl::StatusOr<std::shared_ptr<const Mesh>> store(AtomicFile file, const MeshLabel& label, std::size_t size) const;

  /// Whether there is a file of this key.
  bool holds(const std::string& key) const;
  /// Looks a mesh up, whichever process stored it, without reading its bytes. NotFound, also where its file is damaged: then the
  /// log says so, and it is removed.
  absl::StatusOr<std::shared_ptr<const Mesh>> find(const std::string& key) const;
  /// Bytes of a mesh's file in the store. NotFound, also where there is no store; Unavailable. Waits for the store.
  absl::StatusOr<std::uint64_t> stored_size(const std::string& key) const;
  /// Gets a mesh's file from the store, where its bytes are those of the key. Errors as of stored_size(), and NotFound where they
  /// are not: then it is removed there; ResourceExhausted: the disk is full. Precondition: is_shared().
  absl::Status get(const std::string& key) const;
  /// Counts a mesh as used now.
  void touch(const std::string& key) const;
  void remove(const std::string& key) const;

  struct Stored {
    std::string key;
    std::int64_t last_used = 0;  // nanoseconds
  };
  /// All that are there, the most recently used first.
  std::vector<Stored> list() const;

 private:
  MeshFolder(std::string folder, std::shared_ptr<spdlog::logger> log, WatchedStore* store)
      : folder_(std::move(folder)), log_(std::move(log)), store_(store) {}
  std::string path_of(const std::string& key) const;
  std::shared_ptr<const Mesh> make_mesh(MeshLabel label, std::size_t size) const;

  const std::string folder_;
  const std::shared_ptr<spdlog::logger> log_;
  WatchedStore* const store_;  // may be null
};

}  // namespace curvecast::server
