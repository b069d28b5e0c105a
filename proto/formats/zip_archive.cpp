// SPDX-License-Identifier: Apache-2.0
#include "proto/formats/zip_archive.h"

#include <absl/cleanup/cleanup.h>
#include <absl/strings/str_cat.h>
#include <zip.h>

#include <utility>

namespace curvecast::formats {
namespace {

constexpr zip_uint16_t kTime = 0, kDate = 1 << 5 | 1;  // as MS-DOS has them: 1980-01-01

absl::Status error_of(zip_error_t* error) {
  const std::string text = absl::StrCat("zip archive: ", zip_error_strerror(error));
  const int code = zip_error_code_zip(error);
  zip_error_fini(error);
  if (code == ZIP_ER_MEMORY) return absl::ResourceExhaustedError(text);
  return code == ZIP_ER_EXISTS ? absl::InvalidArgumentError(text) : absl::InternalError(text);
}

absl::Status add_entry(zip_t* archive, const ZipEntry& entry) {
  zip_source_t* const source = zip_source_buffer(archive, entry.bytes.data(), entry.bytes.size(), 0);
  if (source == nullptr) return error_of(zip_get_error(archive));
  const zip_int64_t index = zip_file_add(archive, entry.name.c_str(), source, ZIP_FL_ENC_UTF_8);
  if (index < 0) {
    const absl::Status status = error_of(zip_get_error(archive));
    zip_source_free(source);
    return absl::Status(status.code(), absl::StrCat(status.message(), ": ", entry.name));
  }
  const auto place = static_cast<zip_uint64_t>(index);
  if (zip_set_file_compression(archive, place, ZIP_CM_STORE, 0) != 0 ||
      zip_file_set_dostime(archive, place, kTime, kDate, 0) != 0) {
    return error_of(zip_get_error(archive));
  }
  return absl::OkStatus();
}

absl::StatusOr<std::string> read_all(zip_source_t* source) {
  if (zip_source_open(source) != 0) return error_of(zip_source_error(source));
  const absl::Cleanup close = [source] { zip_source_close(source); };
  if (zip_source_seek(source, 0, SEEK_END) != 0) return error_of(zip_source_error(source));
  const zip_int64_t size = zip_source_tell(source);
  if (size < 0 || zip_source_seek(source, 0, SEEK_SET) != 0) return error_of(zip_source_error(source));
  std::string bytes(static_cast<std::size_t>(size), '\0');
  if (zip_source_read(source, bytes.data(), bytes.size()) != size) return error_of(zip_source_error(source));
  return bytes;
}

}  // namespace

absl::StatusOr<std::string> make_zip_archive(const std::vector<ZipEntry>& entries) {
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* const target = zip_source_buffer_create(nullptr, 0, 0, &error);
  if (target == nullptr) return error_of(&error);
  const absl::Cleanup release = [target] { zip_source_free(target); };
  zip_source_keep(target);  // for us, besides the archive
  zip_t* const archive = zip_open_from_source(target, ZIP_TRUNCATE, &error);
  if (archive == nullptr) {
    zip_source_free(target);
    return error_of(&error);
  }
  absl::Cleanup discard = [archive] { zip_discard(archive); };
  for (const ZipEntry& entry : entries) {
    if (absl::Status status = add_entry(archive, entry); !status.ok()) return status;
  }
  if (zip_close(archive) != 0) return error_of(zip_get_error(archive));
  std::move(discard).Cancel();
  return read_all(target);
}

}  // namespace curvecast::formats
