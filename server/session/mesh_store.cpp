#include "server/session/mesh_store.h"

#include <absl/strings/str_cat.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "server/base/log.h"
#include "server/session/cache_folder.h"

namespace curvecast::server {
namespace {

constexpr std::uint64_t kCharge = 4096;  // for the records of a file, so that countless tiny ones are bounded too
constexpr std::size_t kMaxName = 1024;   // bytes
constexpr std::size_t kMaxId = 32;
constexpr std::uint64_t kMostBesides = 1 << 20;  // bytes of name and sender, in a file in the store
constexpr std::size_t kFirstCapacity = std::size_t{1} << 20;
constexpr std::ptrdiff_t kMostParked = 16, kMostParkedOfOne = 4;
constexpr std::size_t kMostUsers = 64;       // of a file that are noted, besides its sender
constexpr std::uint64_t kUnderWayShare = 2;  // of the store, which a caller's uploads may take: nothing of them can be pushed out

}  // namespace

MeshStore::MeshStore(const MeshLimits& limits, std::string folder, std::unique_ptr<MeshFolder> kept)
    : limits_(limits), folder_(std::move(folder)), kept_(std::move(kept)) {
  if (kept_ == nullptr) return;
  const MutexLock lock(mutex_);
  take_up(kept_->list());
}

std::string MeshStore::realm_of(const std::string& owner) const {
  if (!limits_.isolate) return "";
  Hasher hasher;
  hasher.update("realm\n");
  hasher.update(owner);
  return hasher.hex();
}

std::string MeshStore::key_of(const std::string& id, const std::string& owner) const {
  return MeshLabel{.id = id, .realm = realm_of(owner)}.key();
}

absl::StatusOr<std::shared_ptr<const Mesh>> MeshStore::find(const std::string& id, const std::string& who) {
  absl::StatusOr<std::shared_ptr<const Mesh>> found = find_here(id, who);
  if (found.ok() || !is_shared() || !is_content_id(id)) return found;
  const absl::Status fetched = fetch(key_of(id, who));
  if (absl::IsNotFound(fetched)) return found;
  if (!fetched.ok()) return absl::Status(fetched.code(), absl::StrCat("mesh ", id, " is not held here, and ", fetched.message()));
  return find_here(id, who);
}

absl::Status MeshStore::fetch(const std::string& key) {
  {
    const MutexLock lock(mutex_);
    while (fetching_.contains(key)) fetched_.wait(mutex_);  // another thread gets it
    if (kept_->holds(key)) return absl::OkStatus();
    fetching_.insert(key);
  }
  absl::StatusOr<std::uint64_t> size = kept_->stored_size(key);
  absl::Status status = size.status();
  if (status.ok() && *size > limits_.file_bytes + kMostBesides) status = absl::NotFoundError("it is larger than files may be");
  const std::uint64_t bytes = std::min(size.value_or(0), limits_.file_bytes) + kCharge;
  if (status.ok()) status = reserve("", bytes);
  if (status.ok()) {
    status = kept_->get(key);
    release("", bytes);
  }
  const MutexLock lock(mutex_);
  fetching_.erase(key);
  fetched_.notify_all();
  return status;
}

absl::StatusOr<std::shared_ptr<const Mesh>> MeshStore::find_here(const std::string& id, const std::string& who) {
  const absl::Status not_held =
      absl::NotFoundError(absl::StrCat("mesh \"", printable(id), "\" is not held here; upload it first"));
  if (!is_content_id(id)) return not_held;  // keys of others have more to them
  const std::string key = key_of(id, who);
  const MutexLock lock(mutex_);
  auto found = by_key_.find(key);
  if (found != by_key_.end() && !(*found->second)->status().ok()) {
    if (kept_ != nullptr) kept_->remove(key);
    drop(found->second);
    return not_held;
  }
  // Another server may have removed the file, or this one because it was damaged. Whoever uses it has it still.
  if (kept_ != nullptr && found != by_key_.end() && found->second->use_count() == 1 && !kept_->holds(key)) {
    drop(found->second);
    return not_held;
  }
  if (kept_ != nullptr && found == by_key_.end()) {
    absl::StatusOr<std::shared_ptr<const Mesh>> stored = kept_->find(key);
    if (!stored.ok()) return not_held;
    adopt(*std::move(stored));
    found = by_key_.find(key);
  }
  if (found == by_key_.end()) return not_held;
  if (kept_ != nullptr) kept_->touch(key);
  recency_.splice(recency_.begin(), recency_, found->second);
  return *found->second;
}

void MeshStore::add(const std::string& caller, std::uint64_t held, std::uint64_t under_way) {
  used_ += held;
  Share& share = shares_[caller];
  share.held += held;
  share.under_way += under_way;
}

void MeshStore::subtract(const std::string& caller, std::uint64_t held, std::uint64_t under_way) {
  used_ -= held;
  const auto share = shares_.find(caller);
  share->second.under_way -= under_way;
  if ((share->second.held -= held) == 0) shares_.erase(share);
}

void MeshStore::adopt(std::shared_ptr<const Mesh> mesh) {
  add(mesh->sender, mesh->size() + kCharge, 0);
  const std::string key = mesh->key;
  recency_.push_front(std::move(mesh));
  by_key_[key] = recency_.begin();
}

MeshStore::Recency::iterator MeshStore::drop(Recency::iterator mesh) {
  subtract((*mesh)->sender, (*mesh)->size() + kCharge, 0);
  by_key_.erase((*mesh)->key);
  users_.erase((*mesh)->key);
  return recency_.erase(mesh);
}

void MeshStore::take_up(const std::vector<MeshFolder::Stored>& files) {
  Recency stored;  // the most recently used first, as in the folder
  for (const MeshFolder::Stored& file : files) {
    if (!by_key_.contains(file.key)) {
      absl::StatusOr<std::shared_ptr<const Mesh>> mesh = kept_->find(file.key);
      if (!mesh.ok()) continue;
      adopt(*std::move(mesh));
    }
    stored.splice(stored.end(), recency_, by_key_.at(file.key));
  }
  // What is left has no file any more, or has had one since the folder was read.
  for (auto it = recency_.begin(); it != recency_.end();) {
    it = it->use_count() > 1 || kept_->holds((*it)->key) ? std::next(it) : drop(it);
  }
  recency_.splice(recency_.end(), stored);
}

void MeshStore::note_user(const std::string& key, const std::string& caller) {
  const MutexLock lock(mutex_);
  if (by_key_.contains(key)) add_user(**by_key_.at(key), caller);
}

void MeshStore::add_user(const Mesh& mesh, const std::string& caller) {
  if (limits_.isolate || is_of(mesh, caller)) return;
  std::vector<std::string>& users = users_[mesh.key];
  if (users.size() == kMostUsers) users.erase(users.begin());
  users.push_back(caller);
}

bool MeshStore::is_of(const Mesh& mesh, const std::string& caller) const {
  if (mesh.sender == caller || mesh.sender == kOperator) return true;
  const auto users = users_.find(mesh.key);
  return users != users_.end() && std::ranges::find(users->second, caller) != users->second.end();
}

std::vector<MeshStore::Listed> MeshStore::list(const Maker& who, bool of_all, const std::string& after, std::size_t most) {
  // Others go on while the folder is read; later pages are of what the first one found.
  const bool is_first = kept_ != nullptr && after.empty();
  const auto files = is_first ? kept_->list() : std::vector<MeshFolder::Stored>();
  const std::string realm = key_of("", who.owner);  // with its dash
  std::vector<Listed> out;
  const MutexLock lock(mutex_);
  if (is_first) take_up(files);
  for (auto it = by_key_.upper_bound(realm + after); it != by_key_.end() && out.size() < most; ++it) {
    if (!it->first.starts_with(realm)) break;
    const Mesh& mesh = **it->second;
    const bool is_found = mesh.key.size() == realm.size() + mesh.id.size();  // in nobody's realm, where there is none
    if (is_found && (of_all || limits_.isolate || is_of(mesh, who.caller))) out.push_back({mesh.id, mesh.name, mesh.size()});
  }
  return out;
}

void MeshStore::run_housekeeping() {
  const MutexLock lock(mutex_);
  // As in evict_for(): nobody else can come to use them meanwhile.
  for (const auto& mesh : recency_) {
    if (mesh.use_count() == 1) mesh->close();
  }
}

MeshStore::Parts::iterator MeshStore::find_part(const std::string& id, const Maker& maker) {
  return std::ranges::find_if(parked_, [&](const MeshPart& part) {
    return part.expected_id == id && part.maker.caller == maker.caller && part.maker.owner == maker.owner;
  });
}

void MeshStore::forget(Parts::iterator part) {
  subtract(part->maker.caller, part->reserved, 0);
  parked_.erase(part);
}

std::uint64_t MeshStore::received(const std::string& id, const Maker& maker) {
  const MutexLock lock(mutex_);
  const auto found = find_part(id, maker);
  return found == parked_.end() ? 0 : found->data.size();
}

MeshStore::Usage MeshStore::usage() const {
  const MutexLock lock(mutex_);
  return {recency_.size(), used_, evicted_};
}

void MeshStore::park(MeshPart part) {
  const MutexLock lock(mutex_);
  const std::string caller = part.maker.caller;
  const auto is_his = [&](const MeshPart& other) { return other.maker.caller == caller; };
  shares_[caller].under_way -= part.reserved;
  if (const auto same = find_part(part.expected_id, part.maker); same != parked_.end()) forget(same);
  parked_.push_front(std::move(part));
  if (std::ranges::count_if(parked_, is_his) > kMostParkedOfOne) {
    forget(std::prev(std::ranges::find_if(parked_.rbegin(), parked_.rend(), is_his).base()));
  }
  if (std::ssize(parked_) > kMostParked) forget(std::prev(parked_.end()));
}

absl::StatusOr<MeshPart> MeshStore::resume(const std::string& id, const Maker& maker, std::uint64_t size, std::uint64_t offset) {
  const MutexLock lock(mutex_);
  const auto found = find_part(id, maker);
  const std::uint64_t there = found == parked_.end() ? 0 : found->data.size();
  if (there != offset) {
    return absl::FailedPreconditionError(
        absl::StrCat("header.offset is ", offset, ", but of this file ", there, " bytes are here; ask GetUpload"));
  }
  if (found->claimed != size) {
    return absl::FailedPreconditionError(
        absl::StrCat("header.size is ", size, ", but was ", found->claimed, " when the upload began"));
  }
  MeshPart part = std::move(*found);
  parked_.erase(found);
  shares_[part.maker.caller].under_way += part.reserved;
  return part;
}

bool MeshStore::evict_for(const std::string& caller, std::uint64_t bytes) {
  const std::uint64_t fair = limits_.bytes / shares_.size();
  const auto is_beyond = [&](const std::string& sender) {
    mutex_.assert_held();
    return shares_[sender].held + (sender == caller ? bytes : 0) > fair;
  };
  auto oldest = recency_.rend(), oldest_beyond = recency_.rend();
  for (auto it = recency_.rbegin(); it != recency_.rend() && oldest_beyond == recency_.rend(); ++it) {
    // References to a mesh are only handed out under the lock, so a count of one cannot grow meanwhile.
    if (it->use_count() > 1) continue;
    if (oldest == recency_.rend()) oldest = it;
    if (is_beyond((*it)->sender)) oldest_beyond = it;
  }
  const auto victim = oldest_beyond != recency_.rend() || is_beyond(caller) ? oldest_beyond : oldest;
  if (victim == recency_.rend()) return false;
  if (kept_ != nullptr) kept_->remove((*victim)->key);
  drop(std::prev(victim.base()));
  ++evicted_;
  return true;
}

absl::Status MeshStore::reserve(const std::string& caller, std::uint64_t bytes) {
  const MutexLock lock(mutex_);
  add(caller, 0, 0);  // for who holds nothing has a share, too
  const std::uint64_t most_under_way = std::max(limits_.bytes / kUnderWayShare, limits_.file_bytes + kCharge);
  absl::Status status;
  if (shares_[caller].under_way + bytes > most_under_way) {
    status = absl::ResourceExhaustedError(absl::StrCat("your uploads that are under way have ", shares_[caller].under_way,
                                                       " bytes, as many as a client's may; let one of them end first"));
  }
  if (used_ + bytes > limits_.bytes && kept_ != nullptr) take_up(kept_->list());
  while (status.ok() && used_ + bytes > limits_.bytes && !parked_.empty()) forget(std::prev(parked_.end()));
  while (status.ok() && used_ + bytes > limits_.bytes) {
    if (evict_for(caller, bytes)) continue;
    status = absl::ResourceExhaustedError(
        absl::StrCat("no room for the mesh: the server holds at most ", limits_.bytes, " bytes of mesh files; try again later"));
  }
  status.ok() ? add(caller, bytes, bytes) : subtract(caller, 0, 0);
  return status;
}

void MeshStore::release(const std::string& caller, std::uint64_t bytes) {
  if (bytes == 0) return;  // of an upload that was not begun, or given away
  const MutexLock lock(mutex_);
  subtract(caller, bytes, bytes);
}

std::shared_ptr<const Mesh> MeshStore::keep(std::shared_ptr<const Mesh> mesh, const MeshPart& upload) {
  const MutexLock lock(mutex_);
  const auto found = by_key_.find(mesh->key);
  const bool is_damaged = found != by_key_.end() && !(*found->second)->status().ok();
  if (is_damaged) drop(found->second);
  if (is_damaged || found == by_key_.end()) {
    adopt(std::move(mesh));
  } else {
    recency_.splice(recency_.begin(), recency_, found->second);
    add_user(*recency_.front(), upload.maker.caller);
  }
  subtract(upload.maker.caller, upload.reserved, upload.reserved);
  return recency_.front();
}

MeshUpload::~MeshUpload() {
  if (is_sound_ && is_sized_ && !part_.expected_id.empty() && part_.data.size() > 0 && part_.reserved > 0) {
    store_.park(std::move(part_));
  } else {
    store_.release(part_.maker.caller, part_.reserved);
  }
}

absl::Status MeshUpload::check_header(std::string_view name, std::string_view expected_id) const {
  if (name.size() > kMaxName) {
    return absl::InvalidArgumentError(absl::StrCat("header.name has ", name.size(), " bytes; at most ", kMaxName, " are taken"));
  }
  if (expected_id.size() > kMaxId) {
    return absl::InvalidArgumentError(absl::StrCat("header.mesh_id has ", expected_id.size(), " bytes; a mesh_id has ", kMaxId));
  }
  return store_.kept_ != nullptr ? store_.kept_->may_store() : absl::OkStatus();  // rather now than after all of it
}

absl::Status MeshUpload::begin(std::string_view name, std::uint64_t size, std::string_view expected_id, std::uint64_t offset) {
  if (size == 0) return absl::InvalidArgumentError("header.size is 0: the file is empty");
  if (size > store_.max_file_bytes()) {
    return absl::ResourceExhaustedError(
        absl::StrCat("the file has ", size, " bytes; this server takes at most ", store_.max_file_bytes()));
  }
  if (absl::Status status = check_header(name, expected_id); !status.ok()) return status;
  if (offset == 0) return open(name, size, expected_id);
  absl::StatusOr<MeshPart> part = store_.resume(std::string(expected_id), part_.maker, size, offset);
  if (!part.ok()) return part.status();
  part_ = *std::move(part);
  return absl::OkStatus();
}

absl::Status MeshUpload::begin_unsized(std::string_view name, std::string_view expected_id) {
  if (absl::Status status = check_header(name, expected_id); !status.ok()) return status;
  is_sized_ = false;
  return open(name, store_.max_file_bytes(), expected_id);
}

absl::Status MeshUpload::open(std::string_view name, std::uint64_t claimed, std::string_view expected_id) {
  if (absl::Status status = store_.reserve(part_.maker.caller, kCharge); !status.ok()) return status;
  part_.reserved = kCharge;
  if (store_.kept_ != nullptr) {
    absl::StatusOr<AtomicFile> file = store_.kept_->create();
    if (!file.ok()) return file.status();
    part_.data.open(*std::move(file));
  } else if (!store_.folder_.empty()) {
    // Where the folder is gone or its disk full, there may be memory.
    part_.data.open_in(store_.folder_).IgnoreError();
  }
  part_.name = name;
  part_.expected_id = expected_id;
  part_.claimed = claimed;
  return absl::OkStatus();
}

absl::Status MeshUpload::append(std::string_view chunk) {
  GrowingBytes& data = part_.data;
  if (has_ended_)
    return absl::InvalidArgumentError("a chunk came after the empty one, which is the last of a file without a size");
  has_ended_ = !is_sized_ && chunk.empty();
  if (chunk.size() > part_.claimed - data.size()) {
    is_sound_ = false;
    if (is_sized_) {
      return absl::InvalidArgumentError(absl::StrCat("more than the ", part_.claimed, " bytes that header.size announced"));
    }
    return absl::ResourceExhaustedError(absl::StrCat("the file has more bytes than this server takes, ", part_.claimed));
  }
  const std::size_t needed = data.size() + chunk.size();
  if (needed > data.capacity()) {
    const std::uint64_t ahead = std::max({needed, data.capacity() + data.capacity() / 2, kFirstCapacity});
    const std::size_t capacity = data.is_file() ? needed : static_cast<std::size_t>(std::min(part_.claimed, ahead));
    const std::size_t more = capacity - data.capacity();
    if (absl::Status status = store_.reserve(part_.maker.caller, more); !status.ok()) return status;
    part_.reserved += more;
    if (!data.is_file()) {
      if (absl::Status status = data.reserve(capacity); !status.ok()) return status;
    }
  }
  if (absl::Status status = data.append(chunk); !status.ok()) {
    is_sound_ = false;
    return status;
  }
  part_.hasher.update(chunk);
  return absl::OkStatus();
}

absl::StatusOr<std::shared_ptr<const Mesh>> MeshUpload::finish() {
  if (!is_sized_) {
    if (!has_ended_) {  // a stream that breaks off ends like one that is whole
      return absl::InvalidArgumentError(absl::StrCat("the upload ended after ", part_.data.size(),
                                                     " bytes without the empty chunk that says that the file is whole"));
    }
    if (part_.data.size() == 0) return absl::InvalidArgumentError("the file is empty");
    part_.claimed = part_.data.size();
    if (!part_.data.is_file()) part_.data.reserve(part_.claimed).IgnoreError();  // gives back what it had ahead
  }
  if (part_.data.size() != part_.claimed) {
    return absl::InvalidArgumentError(absl::StrCat("the upload ended after ", part_.data.size(), " of the ", part_.claimed,
                                                   " bytes that header.size announced"));
  }
  const std::string id = part_.hasher.hex();
  if (!part_.expected_id.empty() && part_.expected_id != id) {
    is_sound_ = false;
    return absl::InvalidArgumentError(absl::StrCat("the bytes received hash to ", id, ", not to header.mesh_id \"",
                                                   printable(part_.expected_id), "\"; send the file again"));
  }
  const MeshLabel label{.id = id, .name = part_.name, .sender = part_.maker.caller, .realm = store_.realm_of(part_.maker.owner)};
  if (store_.kept_ != nullptr) {
    is_sound_ = false;  // what cannot be stored is not to be gone on with
    auto stored = store_.kept_->store(part_.data.take_file(), label, part_.claimed);
    if (!stored.ok()) return stored.status();
    return store_.keep(*std::move(stored), std::exchange(part_, MeshPart()));
  }
  absl::StatusOr<MeshBytes> data = part_.data.finish();
  if (!data.ok()) return data.status();
  return store_.keep(std::make_shared<const Mesh>(label, *std::move(data)), std::exchange(part_, MeshPart()));
}

}  // namespace curvecast::server
