#include "server/mesh_store.h"

#include <absl/strings/str_cat.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "server/log.h"

namespace curvecast::server {
namespace {

constexpr std::uint64_t kCharge = 4096;  // for the records of a file, so that countless tiny ones are bounded too
constexpr std::size_t kMaxName = 1024;   // bytes
constexpr std::size_t kFirstCapacity = std::size_t{1} << 20;

}  // namespace

MeshStore::MeshStore(std::uint64_t max_bytes, std::uint64_t max_file_bytes)
    : max_bytes_(max_bytes), max_file_bytes_(max_file_bytes) {}

absl::StatusOr<std::shared_ptr<const Mesh>> MeshStore::find(const std::string& id) {
  const std::lock_guard lock(mutex_);
  const auto found = by_id_.find(id);
  if (found == by_id_.end()) {
    return absl::NotFoundError(absl::StrCat("mesh \"", printable(id), "\" is not held here; upload it first"));
  }
  recency_.splice(recency_.begin(), recency_, found->second);
  return *found->second;
}

MeshStore::Usage MeshStore::usage() const {
  const std::lock_guard lock(mutex_);
  return {recency_.size(), used_};
}

absl::Status MeshStore::reserve(std::uint64_t bytes) {
  const std::lock_guard lock(mutex_);
  // References to a mesh are only handed out under the lock, so a count of one cannot grow meanwhile.
  for (auto it = recency_.end(); used_ + bytes > max_bytes_ && it != recency_.begin();) {
    --it;
    if (it->use_count() > 1) continue;
    used_ -= (*it)->size + kCharge;
    by_id_.erase((*it)->id);
    it = recency_.erase(it);
  }
  if (used_ + bytes > max_bytes_) {
    return absl::ResourceExhaustedError(
        absl::StrCat("no room for the mesh: the server holds at most ", max_bytes_, " bytes of mesh files; try again later"));
  }
  used_ += bytes;
  return absl::OkStatus();
}

void MeshStore::release(std::uint64_t bytes) {
  const std::lock_guard lock(mutex_);
  used_ -= bytes;
}

std::shared_ptr<const Mesh> MeshStore::keep(std::shared_ptr<const Mesh> mesh, std::uint64_t reserved) {
  const std::lock_guard lock(mutex_);
  used_ -= reserved;
  const auto [found, is_new] = by_id_.try_emplace(mesh->id);
  if (is_new) {
    used_ += mesh->size + kCharge;
    recency_.push_front(std::move(mesh));
    found->second = recency_.begin();
  } else {
    recency_.splice(recency_.begin(), recency_, found->second);
  }
  return *found->second;
}

MeshUpload::~MeshUpload() { store_.release(reserved_); }

absl::Status MeshUpload::begin(std::string_view name, std::uint64_t size, std::string_view expected_id) {
  if (name.size() > kMaxName) {
    return absl::InvalidArgumentError(absl::StrCat("header.name has ", name.size(), " bytes; at most ", kMaxName, " are taken"));
  }
  if (size == 0) return absl::InvalidArgumentError("header.size is 0: the file is empty");
  if (size > store_.max_file_bytes()) {
    return absl::ResourceExhaustedError(
        absl::StrCat("the file has ", size, " bytes; this server takes at most ", store_.max_file_bytes()));
  }
  mesh_.name = name;
  expected_id_ = expected_id;
  claimed_ = size;
  if (absl::Status status = store_.reserve(kCharge); !status.ok()) return status;
  reserved_ = kCharge;
  return absl::OkStatus();
}

absl::Status MeshUpload::append(std::string_view chunk) {
  if (chunk.size() > claimed_ - mesh_.size) {
    return absl::InvalidArgumentError(absl::StrCat("more than the ", claimed_, " bytes that header.size announced"));
  }
  const std::size_t needed = mesh_.size + chunk.size();
  if (needed > capacity_) {
    const auto capacity = static_cast<std::size_t>(
        std::min<std::uint64_t>(claimed_, std::max({needed, capacity_ + capacity_ / 2, kFirstCapacity})));
    if (absl::Status status = store_.reserve(capacity - capacity_); !status.ok()) return status;
    reserved_ += capacity - capacity_;
    // realloc, because for large blocks it moves pages instead of bytes and never holds both copies.
    char* grown = static_cast<char*>(std::realloc(mesh_.data.get(), capacity));
    if (grown == nullptr) return absl::ResourceExhaustedError("the server ran out of memory; try again later");
    (void)mesh_.data.release();
    mesh_.data.reset(grown);
    capacity_ = capacity;
  }
  if (!chunk.empty()) std::memcpy(mesh_.data.get() + mesh_.size, chunk.data(), chunk.size());
  mesh_.size = needed;
  hasher_.update(chunk);
  return absl::OkStatus();
}

absl::StatusOr<std::shared_ptr<const Mesh>> MeshUpload::finish() {
  if (mesh_.size != claimed_) {
    return absl::InvalidArgumentError(
        absl::StrCat("the upload ended after ", mesh_.size, " of the ", claimed_, " bytes that header.size announced"));
  }
  mesh_.id = hasher_.hex();
  if (!expected_id_.empty() && expected_id_ != mesh_.id) {
    return absl::InvalidArgumentError(absl::StrCat("the bytes received hash to ", mesh_.id, ", not to header.mesh_id \"",
                                                   printable(expected_id_), "\"; send the file again"));
  }
  auto mesh = std::make_shared<const Mesh>(std::move(mesh_));
  mesh_ = Mesh();
  return store_.keep(std::move(mesh), std::exchange(reserved_, 0));
}

}  // namespace curvecast::server
