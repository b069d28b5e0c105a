// A file's bytes where they lie, as memory that can be read whatever becomes of the file.
#pragma once

#include <absl/status/statusor.h>

#include <cstddef>
#include <span>
#include <utility>

namespace curvecast {

/// The first bytes of a file, to be read only: its own pages, shared with all who map it. Where one cannot be had any more,
/// because the file has become shorter or its disk fails, the system would end the process (SIGBUS). Here it and those after it
/// become zeros from then on, and is_lost() says so: who has read bytes asks it before he uses what came of them. A signal
/// handler, which the first mapping installs, sees to that; what SIGBUS did before goes on for all other memory. Movable; what is
/// const is thread-safe.
class MappedFile {
 public:
  MappedFile() = default;  // of no file
  /// Maps a file that is open for reading, which may be closed then. Errors as the system says. Precondition: size > 0.
  static absl::StatusOr<MappedFile> map(int descriptor, std::size_t size);
  MappedFile(MappedFile&& other) noexcept { *this = std::move(other); }
  MappedFile& operator=(MappedFile&& other) noexcept;
  ~MappedFile();

  std::span<const std::byte> bytes() const { return {data_, size_}; }
  /// Says whether some of the bytes may be zeros that the file never had. Stays so.
  bool is_lost() const;
  /// Lets the system have back the memory of what has been read so far; it can be read again.
  void release_pages() const;

 private:
  struct Place;

  const std::byte* data_ = nullptr;
  std::size_t size_ = 0;
  Place* place_ = nullptr;  // where the handler finds it

  friend struct MappedPlaces;
};

}  // namespace curvecast
