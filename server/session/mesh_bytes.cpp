#include "server/session/mesh_bytes.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "core/base/unnamed_file.h"

namespace curvecast::server {

void MeshBytes::release_pages() const {
  if (is_mapped_) ::madvise(const_cast<char*>(data_.get()), size_, MADV_DONTNEED);
}

GrowingBytes& GrowingBytes::operator=(GrowingBytes&& other) noexcept {
  std::swap(memory_, other.memory_);
  std::swap(size_, other.size_);
  std::swap(capacity_, other.capacity_);
  std::swap(file_, other.file_);
  return *this;
}

GrowingBytes::~GrowingBytes() {
  if (file_ >= 0) ::close(file_);
}

absl::Status GrowingBytes::open_in(const std::string& folder) {
  file_ = open_unnamed_file(folder);
  if (file_ < 0) return absl::ErrnoToStatus(errno, "no room for the file: " + folder);
  return absl::OkStatus();
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
  if (grown == nullptr) return absl::ResourceExhaustedError("the server ran out of memory; try again later");
  (void)memory_.release();
  memory_.reset(grown);
  capacity_ = capacity;
  return absl::OkStatus();
}

absl::StatusOr<MeshBytes> GrowingBytes::finish() {
  MeshBytes bytes;
  bytes.size_ = size_;
  if (!is_file()) {
    bytes.data_ =
        std::shared_ptr<const char>(memory_.release(), [](const char* memory) { std::free(const_cast<char*>(memory)); });
    return bytes;
  }
  void* const data = ::mmap(nullptr, size_, PROT_READ, MAP_SHARED, file_, 0);
  if (data == MAP_FAILED) return absl::ErrnoToStatus(errno, "the file cannot be mapped");
  bytes.data_ = std::shared_ptr<const char>(static_cast<const char*>(data),
                                            [size = size_](const char* mapped) { ::munmap(const_cast<char*>(mapped), size); });
  bytes.is_mapped_ = true;
  return bytes;
}

}  // namespace curvecast::server
