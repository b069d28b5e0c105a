#include "server/session/import_mesh.h"

#include <absl/strings/str_cat.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "server/base/log.h"

namespace curvecast::server {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kChunk = std::size_t{1} << 20;

absl::Status denied(const std::string& path) {
  return absl::PermissionDeniedError(absl::StrCat("\"", printable(path), "\" is not in the folder that this server offers"));
}

bool is_within(const fs::path& file, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first == folder.end();
}

}  // namespace

absl::StatusOr<std::shared_ptr<const Mesh>> import_mesh(MeshStore& store, const Maker& maker, const std::string& folder,
                                                        const std::string& path, const ExecutionContext& context) {
  if (folder.empty()) return absl::PermissionDeniedError("this server offers no folder of meshes; upload the file");
  if (path.find('\0') != std::string::npos) return denied(path);
  std::error_code error;
  const fs::path root = fs::canonical(folder, error);
  if (error) return absl::NotFoundError("the folder that this server offers is not there");
  // Without links, first as far as the file exists: what leads out is refused whether or not it is there.
  const fs::path file = fs::weakly_canonical(root / fs::path(path).relative_path(), error);
  if (error || fs::path(path).is_absolute() || !is_within(file, root)) return denied(path);
  if (!fs::is_regular_file(file, error) || error) {
    return absl::NotFoundError(absl::StrCat("there is no file \"", printable(path), "\" in the folder that this server offers"));
  }
  const std::uintmax_t size = fs::file_size(file, error);
  std::ifstream in(file, std::ios::binary);
  if (error || !in) return absl::NotFoundError(absl::StrCat("\"", printable(path), "\" cannot be read"));
  MeshUpload upload(store, maker);
  if (absl::Status status = upload.begin(file.filename().string(), size, ""); !status.ok()) return status;
  std::string chunk(kChunk, '\0');
  while (in) {
    if (absl::Status status = context.check(); !status.ok()) return status;
    in.read(chunk.data(), static_cast<std::streamsize>(chunk.size()));
    const absl::Status status = upload.append(std::string_view(chunk).substr(0, static_cast<std::size_t>(in.gcount())));
    if (!status.ok()) return status;
  }
  return upload.finish();
}

}  // namespace curvecast::server
