#include "server/session/mesh.h"

#include <absl/strings/str_cat.h>

#include <utility>

namespace curvecast::server {

Mesh::Mesh(MeshLabel label, MeshBytes bytes) : Mesh(std::move(label), bytes.size(), Load()) {
  bytes_ = std::move(bytes);
  is_open_ = is_checked_ = true;
}

Mesh::Mesh(MeshLabel label, std::size_t size, Load load)
    : id(label.id), name(label.name), sender(label.sender), key(label.key()), size_(size), load_(std::move(load)) {}

absl::Status Mesh::open(const ExecutionContext& context) const {
  const MutexLock one_at_a_time(opening_);
  bool is_known_good = false;
  {
    const MutexLock lock(mutex_);
    if (is_open_) return absl::OkStatus();
    is_known_good = is_checked_;
  }
  absl::StatusOr<MeshBytes> loaded = load_(is_known_good, context);
  if (!loaded.ok()) return loaded.status();
  const MutexLock lock(mutex_);
  bytes_ = *std::move(loaded);
  is_open_ = is_checked_ = true;
  return absl::OkStatus();
}

bool Mesh::is_checked() const {
  const MutexLock lock(mutex_);
  return is_checked_;
}

std::span<const char> Mesh::bytes() const {
  const MutexLock lock(mutex_);
  return bytes_.all();
}

absl::Status Mesh::status() const {
  const MutexLock lock(mutex_);
  if (!bytes_.is_lost()) return absl::OkStatus();
  return absl::DataLossError(absl::StrCat("mesh ", id, " was damaged on the server's disk; upload it again"));
}

void Mesh::release_pages() const {
  const MutexLock lock(mutex_);
  bytes_.release_pages();
}

void Mesh::close() const {
  if (!load_) return;
  const MutexLock lock(mutex_);
  bytes_ = {};
  is_open_ = false;
}

}  // namespace curvecast::server
