#include "core/mesh_io/three_mf/zip_archive.h"

#include <absl/cleanup/cleanup.h>
#include <absl/strings/str_format.h>
#include <zip.h>

#include <algorithm>
#include <utility>

#include "core/base/text_scanner.h"
#include "core/mesh_io/reading/endian.h"

namespace curvecast {
namespace {

constexpr std::uint64_t kMostRatio = 100, kUnpackedAnyway = 1 << 20;

absl::Status broken(std::string_view what) {
  return absl::InvalidArgumentError(absl::StrFormat("the ZIP archive is broken: %s", what));
}

std::string words(zip_error_t& error) {
  const std::string text = zip_error_strerror(&error);
  zip_error_fini(&error);
  return text;
}

/// libzip takes a few hundred bytes for each entry, of which the directory takes 46.
absl::Status check_directory(std::uint64_t bytes) {
  constexpr std::uint64_t kMost = 1 << 20;
  if (bytes <= kMost) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrFormat("the directory of the ZIP archive takes %d bytes, more than %d", bytes, kMost));
}

/// Looks at all records by which libzip may find the directory, before it believes one.
absl::Status check_directories(std::string_view bytes) {
  constexpr std::string_view kEnd = "PK\5\6", kLocator64 = "PK\6\7";
  constexpr std::size_t kEndBytes = 22, kLocatorBytes = 20, kEnd64Bytes = 56, kMostComment = 65'535;
  constexpr std::uint32_t kIn64 = UINT32_MAX;  // the size is in the other kind of record
  bool found = false;
  const std::size_t from = bytes.size() - std::min(bytes.size(), kMostComment + kEndBytes);
  for (std::size_t at = bytes.find(kEnd, from); at != std::string_view::npos; at = bytes.find(kEnd, at + 1)) {
    if (bytes.size() - at < kEndBytes) continue;
    found = true;
    const auto size = load<std::uint32_t, false>(bytes.data() + at + 12);
    if (absl::Status status = size == kIn64 ? absl::OkStatus() : check_directory(size); !status.ok()) return status;
    if (at < kLocatorBytes || bytes.substr(at - kLocatorBytes, kLocator64.size()) != kLocator64) continue;
    const auto record = load<std::uint64_t, false>(bytes.data() + at - kLocatorBytes + 8);
    if (record > bytes.size() || bytes.size() - record < kEnd64Bytes) continue;
    if (absl::Status status = check_directory(load<std::uint64_t, false>(bytes.data() + record + 40)); !status.ok())
      return status;
  }
  return found ? absl::OkStatus() : broken("it has no directory at its end; is it cut short?");
}

bool can_be_read(const zip_stat_t& stat) {
  constexpr zip_uint64_t kNeeded = ZIP_STAT_NAME | ZIP_STAT_SIZE | ZIP_STAT_COMP_SIZE | ZIP_STAT_COMP_METHOD;
  if ((stat.valid & kNeeded) != kNeeded) return false;
  if ((stat.valid & ZIP_STAT_ENCRYPTION_METHOD) != 0 && stat.encryption_method != ZIP_EM_NONE) return false;
  if (stat.comp_method != ZIP_CM_STORE && stat.comp_method != ZIP_CM_DEFLATE) return false;
  return stat.comp_size <= UINT64_MAX / (2 * kMostRatio) && stat.size <= kUnpackedAnyway + kMostRatio * stat.comp_size;
}

}  // namespace

bool is_zip(std::string_view bytes) { return bytes.starts_with("PK\3\4"); }

void ZipArchive::Close::operator()(zip* archive) const { zip_discard(archive); }

absl::StatusOr<ZipArchive> ZipArchive::open(std::span<const char> bytes) {
  if (absl::Status status = check_directories({bytes.data(), bytes.size()}); !status.ok()) return status;
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* const source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &error);
  if (source == nullptr) return broken(words(error));
  ZipArchive opened;
  opened.archive_.reset(zip_open_from_source(source, ZIP_RDONLY, &error));
  if (opened.archive_ == nullptr) {
    zip_source_free(source);
    return broken(words(error));
  }
  const zip_int64_t count = zip_get_num_entries(opened.archive_.get(), 0);
  for (zip_uint64_t i = 0; i < static_cast<zip_uint64_t>(std::max<zip_int64_t>(0, count)); ++i) {
    zip_stat_t stat;
    if (zip_stat_index(opened.archive_.get(), i, 0, &stat) != 0 || !can_be_read(stat)) continue;
    opened.entries_.push_back({.index = i, .name = stat.name, .size = stat.size});
  }
  return opened;
}

const ZipEntry* ZipArchive::find(std::string_view name) const {
  const auto found = std::find_if(entries_.begin(), entries_.end(),
                                  [&](const ZipEntry& entry) { return equals_ignoring_case(entry.name, name); });
  return found == entries_.end() ? nullptr : &*found;
}

absl::Status ZipArchive::read(const ZipEntry& entry, const std::function<absl::Status(std::span<const char> block)>& take) const {
  const auto fault = [&](zip_error_t& error) {
    return broken(absl::StrFormat("%s", std::string_view(zip_error_strerror(&error))));
  };
  zip_file_t* const file = zip_fopen_index(archive_.get(), entry.index, 0);
  if (file == nullptr) return fault(*zip_get_error(archive_.get()));
  const absl::Cleanup close = [&] { zip_fclose(file); };
  std::vector<char> block(65'536);
  for (std::uint64_t done = 0;;) {
    const zip_int64_t got = zip_fread(file, block.data(), block.size());
    if (got < 0) return fault(*zip_file_get_error(file));
    done += static_cast<std::uint64_t>(got);
    if (done > entry.size || (got == 0 && done < entry.size)) {
      return broken(absl::StrFormat("the entry does not have the %d bytes that it claims", entry.size));
    }
    if (got == 0) return absl::OkStatus();
    if (absl::Status status = take(std::span(block).first(static_cast<std::size_t>(got))); !status.ok()) return status;
  }
}

}  // namespace curvecast
