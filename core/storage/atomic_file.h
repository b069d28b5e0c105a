// A file that appears under its name whole or not at all, whatever happens to the process or the machine meanwhile.
#pragma once

#include <absl/status/statusor.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace curvecast {

/// Written under a temporary name in the same folder, which no other program takes, or without a name, and renamed at the end.
/// Not thread-safe.
class AtomicFile {
 public:
  /// Creates the temporary, which is for its owner only (mode 0600). Errors name the file and say what the system said;
  /// ResourceExhausted: disk full.
  static absl::StatusOr<AtomicFile> create(const std::string& path);
  /// As create(), in a folder, where the name is known only at the end: commit_as(). Has none until then, if the file system can
  /// do that.
  static absl::StatusOr<AtomicFile> create_in(const std::string& folder);
  AtomicFile(AtomicFile&& other) noexcept;
  AtomicFile& operator=(AtomicFile&& other) = delete;
  ~AtomicFile();  // leaves nothing behind unless committed

  /// Sets the length. Bytes that are never written are zero.
  absl::Status resize(std::uint64_t size);
  absl::Status write_at(std::uint64_t offset, std::span<const std::byte> bytes);
  /// Makes the file durable, and returns the temporary name under which others may read it until then.
  absl::StatusOr<std::string> sync();
  /// Makes the file durable and gives it its name; what had that name before is replaced.
  absl::Status commit();
  /// Gives it its name without waiting for the disk: other processes see it whole, but after a crash of the machine bytes may
  /// lack. For what can be had again and is checked when it is used.
  absl::Status publish();
  /// As commit(), with a name that is given now. Precondition: `path` is in the file system in which it was created.
  absl::Status commit_as(const std::string& path);

  /// To read and map what has been written.
  int descriptor() const { return descriptor_; }

 private:
  AtomicFile(int descriptor, std::string path, std::string temporary);
  /// Gives a file that has no name a temporary one.
  absl::Status take_name();

  int descriptor_ = -1;
  std::string path_, temporary_;  // no temporary: without a name so far, committed or moved from
};

/// Removes what processes that are no more left half-written in a folder; files that a living process writes stay, whichever
/// machine's or container's it is. Returns how many went.
std::size_t remove_stale_temporaries(const std::string& folder);

/// Tells whether a file's name is that of such a temporary.
bool is_temporary(const std::string& name);

}  // namespace curvecast
