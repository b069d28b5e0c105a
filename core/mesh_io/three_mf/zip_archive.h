// A ZIP archive in memory: its files by name, unpacked in blocks. The only door to libzip.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

struct zip;  // libzip's

namespace curvecast {

/// Tells whether the bytes begin as a ZIP archive with a file in it does.
bool is_zip(std::string_view bytes);

struct ZipEntry {
  std::uint64_t index = 0;
  std::string name;
  std::uint64_t size = 0;  // bytes, unpacked: no more come out
};

/// Not thread-safe.
class ZipArchive {
 public:
  /// Opens an archive of bytes that outlive it. InvalidArgument when it is broken or cut short, or when its directory is of more
  /// than a megabyte (memory of eight is taken for it).
  static absl::StatusOr<ZipArchive> open(std::span<const char> bytes);

  /// Lists the entries that can be read: neither encrypted nor packed otherwise than by deflate, nor to more than 100 times their
  /// packed size and a megabyte. The others are left out.
  const std::vector<ZipEntry>& entries() const { return entries_; }
  /// Finds the entry of this name, of which the case of ASCII letters does not count. Null when there is none that can be read.
  const ZipEntry* find(std::string_view name) const;

  /// Unpacks an entry, in blocks. Stops with the first status of `take` that is not OK. InvalidArgument when it is broken, or has
  /// another size or sum of bytes than it claims.
  absl::Status read(const ZipEntry& entry, const std::function<absl::Status(std::span<const char> block)>& take) const;

 private:
  struct Close {
    void operator()(zip* archive) const;
  };
  std::unique_ptr<zip, Close> archive_;
  std::vector<ZipEntry> entries_;
};

}  // namespace curvecast
