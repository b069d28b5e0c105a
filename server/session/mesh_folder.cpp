#include "server/session/mesh_folder.h"

#include <absl/cleanup/cleanup.h>
#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>
#include <fcntl.h>
#include <spdlog/logger.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <functional>
#include <span>
#include <string_view>
#include <system_error>
#include <utility>

#include "server/base/hash.h"
#include "server/base/log.h"
#include "server/session/cache_folder.h"

namespace curvecast::server {
namespace {

namespace fs = std::filesystem;

constexpr char kEnding[] = ".mesh";
constexpr char kMagic[8] = {'C', 'V', 'C', 'M', 'E', 'S', 'H', '1'};
constexpr std::size_t kMaxName = 1 << 16;              // bytes
constexpr std::size_t kHashed = std::size_t{8} << 20;  // bytes between two looks at the context

/// The end of a file. Its bytes and name come before it.
struct Trailer {
  std::uint64_t size = 0;  // of the mesh file
  std::uint64_t name_size = 0;
  std::uint64_t checksum = 0;  // XXH3-64 of the name and both sizes
  char magic[8] = {};
};
static_assert(sizeof(Trailer) == 32);

std::uint64_t checksum_of(const Trailer& trailer, std::string_view name) {
  const std::uint64_t sizes[] = {trailer.size, trailer.name_size};
  return XXH3_64bits_withSeed(name.data(), name.size(), XXH3_64bits(sizes, sizeof sizes));
}

int open_to_read(const std::string& path) { return ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY); }

bool read_at(int descriptor, std::uint64_t offset, std::span<char> out) {
  while (!out.empty()) {
    const ssize_t got = ::pread(descriptor, out.data(), out.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    out = out.subspan(static_cast<std::size_t>(got));
    offset += static_cast<std::uint64_t>(got);
  }
  return true;
}

struct Description {
  std::string name;
  std::uint64_t size = 0;
};

/// What an open file's trailer says; DataLoss where it makes no sense.
absl::StatusOr<Description> describe(int descriptor, const std::string& path) {
  struct stat status = {};
  if (::fstat(descriptor, &status) != 0) return absl::ErrnoToStatus(errno, absl::StrCat(path, ": cannot read"));
  const absl::Status damaged = absl::DataLossError(absl::StrCat(path, ": damaged: its end makes no sense"));
  const auto whole = static_cast<std::uint64_t>(status.st_size);
  Trailer trailer;
  if (!S_ISREG(status.st_mode) || whole < sizeof trailer) return damaged;
  const std::uint64_t room = whole - sizeof trailer;
  if (!read_at(descriptor, room, {reinterpret_cast<char*>(&trailer), sizeof trailer})) return damaged;
  if (std::memcmp(trailer.magic, kMagic, sizeof kMagic) != 0 || trailer.name_size > std::min<std::uint64_t>(room, kMaxName) ||
      trailer.size == 0 || trailer.size != room - trailer.name_size) {
    return damaged;
  }
  Description out{std::string(trailer.name_size, '\0'), trailer.size};
  if (!read_at(descriptor, trailer.size, out.name) || checksum_of(trailer, out.name) != trailer.checksum) return damaged;
  return out;
}

/// OK where the bytes are those that the id promises, else DataLoss.
absl::Status check_hash(std::span<const char> bytes, const std::string& id, const std::string& path,
                        const ExecutionContext& context) {
  Hasher hasher;
  for (std::size_t at = 0; at < bytes.size(); at += kHashed) {
    if (absl::Status status = context.check(); !status.ok()) return status;
    const std::span<const char> some = bytes.subspan(at, std::min(kHashed, bytes.size() - at));
    hasher.update({some.data(), some.size()});
  }
  return hasher.hex() == id ? absl::OkStatus()
                            : absl::DataLossError(absl::StrCat(path, ": damaged: its bytes are not its name's"));
}

absl::Status not_found(const std::string& id) {
  return absl::NotFoundError(absl::StrCat("mesh \"", printable(id), "\" is not held here any more; upload it again"));
}

void discard(spdlog::logger& log, const std::string& path, const std::string& reason) {
  std::error_code ignored;
  const bool removed = fs::remove(path, ignored);
  log.warn("meshes: {}{}", reason, removed ? "; removed" : "");
}

/// A file's bytes; DataLoss where they are not those of a mesh of this id and size.
absl::StatusOr<MeshBytes> read(int descriptor, const std::string& path, const std::string& id, std::size_t size,
                               bool is_known_good, const ExecutionContext& context) {
  const absl::StatusOr<Description> described = describe(descriptor, path);
  if (!described.ok()) return described.status();
  if (described->size != size) return absl::DataLossError(absl::StrCat(path, ": damaged: its length has changed"));
  absl::StatusOr<MeshBytes> bytes = MeshBytes::of_file(descriptor, size);
  if (!bytes.ok() || is_known_good) return bytes;
  absl::Status status = check_hash(bytes->all(), id, path, context);
  if (!status.ok()) return status;
  return bytes;
}

absl::StatusOr<MeshBytes> load(const std::string& path, const std::string& id, std::size_t size, bool is_known_good,
                               spdlog::logger& log, const ExecutionContext& context) {
  const int descriptor = open_to_read(path);
  if (descriptor < 0) {
    absl::Status status = absl::ErrnoToStatus(errno, absl::StrCat(path, ": cannot open"));
    return absl::IsNotFound(status) ? not_found(id) : status;
  }
  const absl::Cleanup close = [descriptor] { ::close(descriptor); };
  absl::StatusOr<MeshBytes> bytes = read(descriptor, path, id, size, is_known_good, context);
  if (!absl::IsDataLoss(bytes.status())) return bytes;
  discard(log, path, std::string(bytes.status().message()));
  return not_found(id);
}

}  // namespace

absl::StatusOr<std::unique_ptr<MeshFolder>> MeshFolder::open(const std::string& cache, std::shared_ptr<spdlog::logger> log) {
  const absl::StatusOr<std::string> path = make_cache_folder(cache + "/meshes");
  if (!path.ok()) return path.status();
  const std::size_t stale = remove_stale_temporaries(*path);
  std::unique_ptr<MeshFolder> folder(new MeshFolder(*path, std::move(log)));
  folder->log_->info("meshes {}: {} files, {} unfinished ones removed", *path, folder->list().size(), stale);
  return folder;
}

std::string MeshFolder::path_of(const std::string& id) const { return absl::StrCat(folder_, "/", id, kEnding); }

absl::StatusOr<AtomicFile> MeshFolder::create() const {
  absl::StatusOr<AtomicFile> file = AtomicFile::create_in(folder_);
  if (file.ok() || absl::IsResourceExhausted(file.status())) return file;
  return absl::UnavailableError(absl::StrCat("the server cannot keep meshes: ", file.status().message()));
}

absl::StatusOr<std::shared_ptr<const Mesh>> MeshFolder::store(AtomicFile file, const std::string& id, const std::string& name,
                                                              std::size_t size) const {
  Trailer trailer{.size = size, .name_size = name.size()};
  trailer.checksum = checksum_of(trailer, name);
  std::memcpy(trailer.magic, kMagic, sizeof kMagic);
  absl::Status status = file.write_at(size, std::as_bytes(std::span(name)));
  if (status.ok()) status = file.write_at(size + name.size(), std::as_bytes(std::span(&trailer, 1)));
  if (status.ok()) status = file.commit_as(path_of(id));
  if (status.ok()) return make_mesh(id, name, size);
  log_->error("meshes: {} \"{}\" is not kept: {}", id, printable(name), std::string(status.message()));
  if (absl::IsResourceExhausted(status)) return absl::ResourceExhaustedError("the server's disk is full; try again later");
  return absl::UnavailableError(absl::StrCat("the server cannot keep the mesh: ", status.message()));
}

std::shared_ptr<const Mesh> MeshFolder::make_mesh(const std::string& id, std::string name, std::size_t size) const {
  return std::make_shared<const Mesh>(
      id, std::move(name), size, [path = path_of(id), id, size, log = log_](bool is_known_good, const ExecutionContext& context) {
        return load(path, id, size, is_known_good, *log, context);
      });
}

bool MeshFolder::holds(const std::string& id) const { return is_content_id(id) && is_file(path_of(id)); }

absl::StatusOr<std::shared_ptr<const Mesh>> MeshFolder::find(const std::string& id) const {
  if (!is_content_id(id)) return not_found(id);
  const std::string path = path_of(id);
  const int descriptor = open_to_read(path);
  if (descriptor < 0) return not_found(id);
  const absl::Cleanup close = [descriptor] { ::close(descriptor); };
  absl::StatusOr<Description> described = describe(descriptor, path);
  if (described.ok()) return make_mesh(id, std::move(described->name), described->size);
  if (absl::IsDataLoss(described.status())) discard(*log_, path, std::string(described.status().message()));
  return not_found(id);
}

void MeshFolder::touch(const std::string& id) const { touch_file(path_of(id)); }

void MeshFolder::remove(const std::string& id) const {
  std::error_code ignored;
  fs::remove(path_of(id), ignored);
}

std::vector<MeshFolder::Stored> MeshFolder::list() const {
  std::vector<Stored> out;
  std::error_code error;
  for (fs::directory_iterator it(folder_, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    struct stat status = {};
    if (!absl::EndsWith(name, kEnding) || ::lstat(it->path().c_str(), &status) != 0 || !S_ISREG(status.st_mode)) continue;
    std::string id = name.substr(0, name.size() - std::strlen(kEnding));
    if (is_content_id(id)) out.push_back({std::move(id), status.st_mtim.tv_sec * 1'000'000'000 + status.st_mtim.tv_nsec});
  }
  std::ranges::sort(out, std::ranges::greater(), &Stored::last_used);
  return out;
}

}  // namespace curvecast::server
