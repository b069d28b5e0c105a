// The mesh files that clients have sent, named by their content.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/mutex.h"
#include "server/base/hash.h"
#include "server/session/maker.h"
#include "server/session/mesh.h"
#include "server/session/mesh_bytes.h"
#include "server/session/mesh_folder.h"

namespace curvecast::server {

/// The beginning of a file whose upload is under way or broke off.
struct MeshPart {
  std::string name;
  Maker maker;
  GrowingBytes data;
  Hasher hasher;
  std::string expected_id;     // empty: not known beforehand
  std::uint64_t claimed = 0;   // bytes of the whole; at most, where its size is not known
  std::uint64_t reserved = 0;  // bytes of the store's budget: the data's capacity and a fixed charge
};

/// What a store holds at most.
struct MeshLimits {
  std::uint64_t bytes = 0;       // of all files together
  std::uint64_t file_bytes = 0;  // of one
  bool isolate = false;          // each owner finds what was sent for him, and nothing else
};

/// Thread-safe. Holds whole files, uploads under way, and the beginnings of uploads that broke off, within one budget, of which
/// each caller has the same share as soon as room is wanted: beginnings go first, then files to which there are no references,
/// those of callers beyond their share before others, and of these the least recently used.
class MeshStore {
 public:
  /// Files are kept in `folder`, without names; where that is empty or cannot be used, in memory. With `kept`, which may be null,
  /// they survive: what other stores, or one before, have kept there is held here too.
  explicit MeshStore(const MeshLimits& limits, std::string folder = {}, std::unique_ptr<MeshFolder> kept = nullptr);

  /// Finds a file by its hash, whose bytes may still have to be brought in: see Mesh::open(). `who`: the owner who asks; matters
  /// only where owners are isolated. NotFound says what to do. Where is_shared(), what is not here is got from the store that
  /// servers share, which may take its time: Unavailable where that is away, ResourceExhausted where there is no room.
  absl::StatusOr<std::shared_ptr<const Mesh>> find(const std::string& id, const std::string& who = {});
  /// Counts a file that is here as a caller's too, as list() does: it has the id, and was told that it need not send the bytes.
  void note_user(const std::string& key, const std::string& caller);

  /// A file as list() tells of it.
  struct Listed {
    std::string id, name;
    std::uint64_t size = 0;  // bytes
  };
  /// Lists files that are here, by id, at most `most` of those after the id `after`: of those that find() finds for the owner
  /// what the caller sent or note_user() said, and what the server took for itself; all of them where `of_all`. With an empty
  /// `after` it reads the folder first, which may take its time.
  std::vector<Listed> list(const Maker& who, bool of_all, const std::string& after, std::size_t most);

  /// How many bytes are there of the file with this hash, whose upload by the same client broke off.
  std::uint64_t received(const std::string& id, const Maker& maker = {});

  /// Whether find() may wait for a store.
  bool is_shared() const { return kept_ != nullptr && kept_->is_shared(); }

  std::uint64_t max_file_bytes() const { return limits_.file_bytes; }

  struct Usage {
    std::size_t meshes = 0;
    std::uint64_t bytes = 0;    // of the meshes and of uploads under way
    std::uint64_t evicted = 0;  // meshes that went so far to make room for others
  };
  Usage usage() const;
  /// Puts the bytes of files that nobody uses back on the disk. To be called now and then.
  void run_housekeeping();

 private:
  friend class MeshUpload;
  using Recency = std::list<std::shared_ptr<const Mesh>>;  // most recently used first

  absl::StatusOr<std::shared_ptr<const Mesh>> find_here(const std::string& id, const std::string& who)
      ABSL_LOCKS_EXCLUDED(mutex_);
  /// Gets a file from the store into the folder. Errors as of find().
  absl::Status fetch(const std::string& key) ABSL_LOCKS_EXCLUDED(mutex_);
  /// Takes a mesh up that is in the folder.
  void adopt(std::shared_ptr<const Mesh> mesh) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  /// Forgets a mesh; its file stays. Returns what follows it.
  Recency::iterator drop(Recency::iterator mesh) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  /// Takes up what others have stored or removed, and how recently they have used it. `files`: MeshFolder::list(), of just now.
  void take_up(const std::vector<MeshFolder::Stored>& files) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  /// Whether list() tells a caller of a file that find() would find.
  bool is_of(const Mesh& mesh, const std::string& caller) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void add_user(const Mesh& mesh, const std::string& caller) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  /// What there is of one caller, bytes.
  struct Share {
    std::uint64_t held = 0;       // all
    std::uint64_t under_way = 0;  // of uploads that are connected
  };
  /// Who may find what is for this owner: as MeshLabel::realm.
  std::string realm_of(const std::string& owner) const;
  std::string key_of(const std::string& id, const std::string& owner) const;
  void add(const std::string& caller, std::uint64_t held, std::uint64_t under_way) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void subtract(const std::string& caller, std::uint64_t held, std::uint64_t under_way) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  /// Makes room for more bytes of a caller by letting go of a file. False where there is none that he may push out.
  bool evict_for(const std::string& caller, std::uint64_t bytes) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  absl::Status reserve(const std::string& caller, std::uint64_t bytes) ABSL_LOCKS_EXCLUDED(mutex_);
  void release(const std::string& caller, std::uint64_t bytes) ABSL_LOCKS_EXCLUDED(mutex_);
  /// Takes a file up that was an upload with so many bytes reserved.
  std::shared_ptr<const Mesh> keep(std::shared_ptr<const Mesh> mesh, const MeshPart& upload) ABSL_LOCKS_EXCLUDED(mutex_);
  using Parts = std::list<MeshPart>;
  /// The part of that file that the client has sent; the end where there is none.
  Parts::iterator find_part(const std::string& id, const Maker& maker) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void forget(Parts::iterator part) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  /// Keeps a part for a later upload, instead of any other part of the same file.
  void park(MeshPart part) ABSL_LOCKS_EXCLUDED(mutex_);
  /// A part of which `offset` bytes have come, of a file of `size` bytes. FailedPrecondition where there is none.
  absl::StatusOr<MeshPart> resume(const std::string& id, const Maker& maker, std::uint64_t size, std::uint64_t offset)
      ABSL_LOCKS_EXCLUDED(mutex_);

  const MeshLimits limits_;
  const std::string folder_;
  const std::unique_ptr<MeshFolder> kept_;  // null: no file survives
  mutable Mutex mutex_;
  std::uint64_t used_ ABSL_GUARDED_BY(mutex_) = 0;               // bytes of `recency_` and of all uploads
  std::map<std::string, Share> shares_ ABSL_GUARDED_BY(mutex_);  // by caller; of whom there is something
  std::uint64_t evicted_ ABSL_GUARDED_BY(mutex_) = 0;
  Recency recency_ ABSL_GUARDED_BY(mutex_);
  std::map<std::string, Recency::iterator> by_key_ ABSL_GUARDED_BY(mutex_);
  /// By key: callers besides the sender who have the file, too, the newest last.
  std::map<std::string, std::vector<std::string>> users_ ABSL_GUARDED_BY(mutex_);
  Parts parked_ ABSL_GUARDED_BY(mutex_);  // the newest first; within used_ too
  CondVar fetched_;
  std::set<std::string> fetching_ ABSL_GUARDED_BY(mutex_);  // keys
};

/// One file on its way into the store, which must outlive it. Not thread-safe.
class MeshUpload {
 public:
  explicit MeshUpload(MeshStore& store, Maker maker = {}) : store_(store) { part_.maker = std::move(maker); }
  ~MeshUpload();  // keeps an unfinished file for another upload if the file's hash is known
  MeshUpload(const MeshUpload&) = delete;
  MeshUpload& operator=(const MeshUpload&) = delete;

  /// Begins a file of `size` bytes, which the client claims: it is checked, never allocated ahead. `expected_id` is the file's
  /// hash; empty: not known. Above 0, `offset` resumes an upload that broke off: FailedPrecondition where it is not
  /// MeshStore::received(expected_id). ResourceExhausted where there is no room, or too much is under way of this caller;
  /// InvalidArgument for the rest.
  absl::Status begin(std::string_view name, std::uint64_t size, std::string_view expected_id, std::uint64_t offset = 0);
  /// The same of a file whose size turns out at its end, after which an empty chunk has to come. It cannot be resumed.
  absl::Status begin_unsized(std::string_view name, std::string_view expected_id);
  /// Takes the next bytes. InvalidArgument where there are more than announced; ResourceExhausted where there is no room, or the
  /// file becomes larger than files may be.
  absl::Status append(std::string_view chunk);
  /// Stores the file, and returns it or the one already held for the same bytes. Where files survive, this one does from now on,
  /// and the call waits for the disk. InvalidArgument for a wrong size or hash; ResourceExhausted and Unavailable where it cannot
  /// be stored.
  absl::StatusOr<std::shared_ptr<const Mesh>> finish();

 private:
  /// Whether a file of this name may be taken now.
  absl::Status check_header(std::string_view name, std::string_view expected_id) const;
  /// Makes ready for the first bytes of a file that has `claimed` at most.
  absl::Status open(std::string_view name, std::uint64_t claimed, std::string_view expected_id);

  MeshStore& store_;
  MeshPart part_;
  bool is_sized_ = true;    // part_.claimed is what the file has
  bool has_ended_ = false;  // of one without a size: by an empty chunk
  bool is_sound_ = true;    // no more bytes came than there should
};

}  // namespace curvecast::server
