#include "server/session/mesh_bytes.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "core/base/file_system.h"
#include "core/base/unnamed_file.h"

namespace curvecast::server {
namespace {

absl::Status out_of_memory() { return absl::ResourceExhaustedError("the server ran out of memory; try again later"); }

std::shared_ptr<const char> share(char* memory) {
  return {memory, [](const char* owned) { std::free(const_cast<char*>(owned)); }};
}

}  // namespace

absl::StatusOr<MeshBytes> MeshBytes::of_file(int descriptor, std::size_t size) {
  MeshBytes bytes;
  bytes.size_ = size;
  if (is_on_local_disk(descriptor)) {
    absl::StatusOr<MappedFile> mapped = MappedFile::map(descriptor, size);
    if (!mapped.ok()) return mapped.status();
    bytes.mapping_ = std::make_shared<const MappedFile>(*std::move(mapped));
    bytes.data_ = std::shared_ptr<const char>(bytes.mapping_, reinterpret_cast<const char*>(bytes.mapping_->bytes().data()));
    return bytes;
  }
  char* const memory = static_cast<char*>(std::malloc(size));
  if (memory == nullptr) return out_of_memory();
  bytes.data_ = share(memory);
  for (std::size_t at = 0; at < size;) {
    const ssize_t got = ::pread(descriptor, memory + at, size - at, static_cast<off_t>(at));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return absl::ErrnoToStatus(errno, "the file cannot be read");
    if (got == 0) return absl::DataLossError("the file became shorter while it was read");
    at += static_cast<std::size_t>(got);
  }
  return bytes;
}

void MeshBytes::release_pages() const {
  if (mapping_ != nullptr) mapping_->release_pages();
}

GrowingBytes& GrowingBytes::operator=(GrowingBytes&& other) noexcept {
  std::swap(memory_, other.memory_);
  std::swap(size_, other.size_);
  std::swap(capacity_, other.capacity_);
  std::swap(file_, other.file_);
  std::swap(named_, other.named_);
  return *this;
}

GrowingBytes::~GrowingBytes() {
  if (file_ >= 0 && named_ == nullptr) ::close(file_);
}

absl::Status GrowingBytes::open_in(const std::string& folder) {
  file_ = open_unnamed_file(folder);
  if (file_ < 0) return absl::ErrnoToStatus(errno, "no room for the file: " + folder);
  return absl::OkStatus();
}

void GrowingBytes::open(AtomicFile file) {
  named_ = std::make_unique<AtomicFile>(std::move(file));
  file_ = named_->descriptor();
}

AtomicFile GrowingBytes::take_file() {
  file_ = -1;
  return std::move(*std::exchange(named_, nullptr));
}

absl::Status GrowingBytes::append(std::string_view bytes) {
  if (!is_file()) {
    if (!bytes.empty()) std::memcpy(memory_.get() + size_, bytes.data(), bytes.size());
    size_ += bytes.size();
    return absl::OkStatus();
  }
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(file_, bytes.data(), bytes.size(), static_cast<off_t>(size_));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return absl::ErrnoToStatus(written == 0 ? ENOSPC : errno, "the file cannot be kept on the server's disk");
    size_ += static_cast<std::size_t>(written);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return absl::OkStatus();
}

absl::Status GrowingBytes::reserve(std::size_t capacity) {
  // realloc, because for large blocks it moves pages instead of bytes and never holds both copies.
  char* const grown = static_cast<char*>(std::realloc(memory_.get(), capacity));
  if (grown == nullptr) return out_of_memory();
  (void)memory_.release();
  memory_.reset(grown);
  capacity_ = capacity;
  return absl::OkStatus();
}

absl::StatusOr<MeshBytes> GrowingBytes::finish() {
  if (is_file()) return MeshBytes::of_file(file_, size_);
  MeshBytes bytes;
  bytes.size_ = size_;
  bytes.data_ = share(memory_.release());
  return bytes;
}

}  // namespace curvecast::server
