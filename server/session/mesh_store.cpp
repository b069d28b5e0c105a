#include "server/session/mesh_store.h"

#include <absl/strings/str_cat.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "server/base/log.h"

namespace curvecast::server {
namespace {

constexpr std::uint64_t kCharge = 4096;  // for the records of a file, so that countless tiny ones are bounded too
constexpr std::size_t kMaxName = 1024;   // bytes
constexpr std::size_t kMaxId = 32;
constexpr std::size_t kFirstCapacity = std::size_t{1} << 20;
constexpr std::size_t kMostParked = 16;

}  // namespace

MeshStore::MeshStore(std::uint64_t max_bytes, std::uint64_t max_file_bytes, std::string folder)
    : MeshStore(max_bytes, max_file_bytes, std::move(folder), nullptr) {}

MeshStore::MeshStore(std::uint64_t max_bytes, std::uint64_t max_file_bytes, std::string folder, std::unique_ptr<MeshFolder> kept)
    : max_bytes_(max_bytes), max_file_bytes_(max_file_bytes), folder_(std::move(folder)), kept_(std::move(kept)) {
  const MutexLock lock(mutex_);
  look_into_folder();
}

absl::StatusOr<std::shared_ptr<const Mesh>> MeshStore::find(const std::string& id) {
  const absl::Status not_held =
      absl::NotFoundError(absl::StrCat("mesh \"", printable(id), "\" is not held here; upload it first"));
  const MutexLock lock(mutex_);
  auto found = by_id_.find(id);
  if (found != by_id_.end() && !(*found->second)->status().ok()) {
    if (kept_ != nullptr) kept_->remove(id);
    drop(found->second);
    return not_held;
  }
  // Another server may have removed the file, or this one because it was damaged. Whoever uses it has it still.
  if (kept_ != nullptr && found != by_id_.end() && found->second->use_count() == 1 && !kept_->holds(id)) {
    drop(found->second);
    return not_held;
  }
  if (kept_ != nullptr && found == by_id_.end()) {
    absl::StatusOr<std::shared_ptr<const Mesh>> stored = kept_->find(id);
    if (!stored.ok()) return not_held;
    adopt(*std::move(stored));
    found = by_id_.find(id);
  }
  if (found == by_id_.end()) return not_held;
  if (kept_ != nullptr) kept_->touch(id);
  recency_.splice(recency_.begin(), recency_, found->second);
  return *found->second;
}

void MeshStore::adopt(std::shared_ptr<const Mesh> mesh) {
  used_ += mesh->size() + kCharge;
  const std::string id = mesh->id;
  recency_.push_front(std::move(mesh));
  by_id_[id] = recency_.begin();
}

MeshStore::Recency::iterator MeshStore::drop(Recency::iterator mesh) {
  used_ -= (*mesh)->size() + kCharge;
  by_id_.erase((*mesh)->id);
  return recency_.erase(mesh);
}

void MeshStore::look_into_folder() {
  if (kept_ == nullptr) return;
  Recency stored;  // the most recently used first, as in the folder
  for (const MeshFolder::Stored& file : kept_->list()) {
    if (!by_id_.contains(file.id)) {
      absl::StatusOr<std::shared_ptr<const Mesh>> mesh = kept_->find(file.id);
      if (!mesh.ok()) continue;
      adopt(*std::move(mesh));
    }
    stored.splice(stored.end(), recency_, by_id_.at(file.id));
  }
  // What is left has no file any more.
  for (auto it = recency_.begin(); it != recency_.end();) it = it->use_count() > 1 ? std::next(it) : drop(it);
  recency_.splice(recency_.end(), stored);
}

void MeshStore::run_housekeeping() {
  const MutexLock lock(mutex_);
  // As in reserve(): nobody else can come to use them meanwhile.
  for (const auto& mesh : recency_) {
    if (mesh.use_count() == 1) mesh->close();
  }
}

std::uint64_t MeshStore::received(const std::string& id) {
  const MutexLock lock(mutex_);
  const auto found = std::ranges::find(parked_, id, &MeshPart::expected_id);
  return found == parked_.end() ? 0 : found->data.size();
}

MeshStore::Usage MeshStore::usage() const {
  const MutexLock lock(mutex_);
  return {recency_.size(), used_};
}

void MeshStore::park(MeshPart part) {
  const MutexLock lock(mutex_);
  const auto forget = [this](std::list<MeshPart>::iterator old) {
    mutex_.assert_held();
    used_ -= old->reserved;
    parked_.erase(old);
  };
  if (const auto same = std::ranges::find(parked_, part.expected_id, &MeshPart::expected_id); same != parked_.end()) forget(same);
  parked_.push_front(std::move(part));
  if (parked_.size() > kMostParked) forget(std::prev(parked_.end()));
}

absl::StatusOr<MeshPart> MeshStore::resume(const std::string& id, std::uint64_t size, std::uint64_t offset) {
  const MutexLock lock(mutex_);
  const auto found = std::ranges::find(parked_, id, &MeshPart::expected_id);
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
  return part;
}

absl::Status MeshStore::reserve(std::uint64_t bytes) {
  const MutexLock lock(mutex_);
  if (used_ + bytes > max_bytes_) look_into_folder();
  while (used_ + bytes > max_bytes_ && !parked_.empty()) {
    used_ -= parked_.back().reserved;
    parked_.pop_back();
  }
  // References to a mesh are only handed out under the lock, so a count of one cannot grow meanwhile.
  for (auto it = recency_.end(); used_ + bytes > max_bytes_ && it != recency_.begin();) {
    --it;
    if (it->use_count() > 1) continue;
    if (kept_ != nullptr) kept_->remove((*it)->id);
    it = drop(it);
  }
  if (used_ + bytes > max_bytes_) {
    return absl::ResourceExhaustedError(
        absl::StrCat("no room for the mesh: the server holds at most ", max_bytes_, " bytes of mesh files; try again later"));
  }
  used_ += bytes;
  return absl::OkStatus();
}

void MeshStore::release(std::uint64_t bytes) {
  const MutexLock lock(mutex_);
  used_ -= bytes;
}

std::shared_ptr<const Mesh> MeshStore::keep(std::shared_ptr<const Mesh> mesh, std::uint64_t reserved) {
  const MutexLock lock(mutex_);
  used_ -= reserved;
  const auto found = by_id_.find(mesh->id);
  const bool is_damaged = found != by_id_.end() && !(*found->second)->status().ok();
  if (is_damaged) drop(found->second);
  if (is_damaged || found == by_id_.end()) {
    adopt(std::move(mesh));
  } else {
    recency_.splice(recency_.begin(), recency_, found->second);
  }
  return recency_.front();
}

MeshUpload::~MeshUpload() {
  if (is_sound_ && !part_.expected_id.empty() && part_.data.size() > 0 && part_.reserved > 0) {
    store_.park(std::move(part_));
  } else {
    store_.release(part_.reserved);
  }
}

absl::Status MeshUpload::begin(std::string_view name, std::uint64_t size, std::string_view expected_id, std::uint64_t offset) {
  if (name.size() > kMaxName) {
    return absl::InvalidArgumentError(absl::StrCat("header.name has ", name.size(), " bytes; at most ", kMaxName, " are taken"));
  }
  if (expected_id.size() > kMaxId) {
    return absl::InvalidArgumentError(absl::StrCat("header.mesh_id has ", expected_id.size(), " bytes; a mesh_id has ", kMaxId));
  }
  if (size == 0) return absl::InvalidArgumentError("header.size is 0: the file is empty");
  if (size > store_.max_file_bytes()) {
    return absl::ResourceExhaustedError(
        absl::StrCat("the file has ", size, " bytes; this server takes at most ", store_.max_file_bytes()));
  }
  if (offset > 0) {
    absl::StatusOr<MeshPart> part = store_.resume(std::string(expected_id), size, offset);
    if (!part.ok()) return part.status();
    part_ = *std::move(part);
    return absl::OkStatus();
  }
  if (absl::Status status = store_.reserve(kCharge); !status.ok()) return status;
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
  part_.claimed = size;
  return absl::OkStatus();
}

absl::Status MeshUpload::append(std::string_view chunk) {
  GrowingBytes& data = part_.data;
  if (chunk.size() > part_.claimed - data.size()) {
    is_sound_ = false;
    return absl::InvalidArgumentError(absl::StrCat("more than the ", part_.claimed, " bytes that header.size announced"));
  }
  const std::size_t needed = data.size() + chunk.size();
  if (needed > data.capacity()) {
    const std::uint64_t ahead = std::max({needed, data.capacity() + data.capacity() / 2, kFirstCapacity});
    const std::size_t capacity = data.is_file() ? needed : static_cast<std::size_t>(std::min(part_.claimed, ahead));
    const std::size_t more = capacity - data.capacity();
    if (absl::Status status = store_.reserve(more); !status.ok()) return status;
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
  if (store_.kept_ != nullptr) {
    is_sound_ = false;  // what cannot be stored is not to be gone on with
    auto stored = store_.kept_->store(part_.data.take_file(), id, part_.name, part_.claimed);
    if (!stored.ok()) return stored.status();
    const MeshPart done = std::exchange(part_, MeshPart());
    return store_.keep(*std::move(stored), done.reserved);
  }
  absl::StatusOr<MeshBytes> data = part_.data.finish();
  if (!data.ok()) return data.status();
  MeshPart done = std::exchange(part_, MeshPart());
  return store_.keep(std::make_shared<const Mesh>(id, std::move(done.name), *std::move(data)), done.reserved);
}

}  // namespace curvecast::server
