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
#include <atomic>
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
// Of what is got from the store, until it is known to be good; removed by the next start where the process is killed meanwhile.
constexpr char kFetched[] = ".curvecast-tmp";
constexpr char kMagic[8] = {'C', 'V', 'C', 'M', 'E', 'S', 'H', '2'};
constexpr std::size_t kIdSize = 32;                    // digits, of a realm too
constexpr std::size_t kMaxText = 1 << 16;              // bytes of name and sender
constexpr std::size_t kHashed = std::size_t{8} << 20;  // bytes between two looks at the context

/// The end of a file. Its bytes, name and sender come before it.
struct Trailer {
  std::uint64_t size = 0;  // of the mesh file
  std::uint64_t name_size = 0, sender_size = 0;
  std::uint64_t checksum = 0;  // XXH3-64 of name, sender and sizes
  char magic[8] = {};
};
static_assert(sizeof(Trailer) == 40);

/// `text`: name and sender.
std::uint64_t checksum_of(const Trailer& trailer, std::string_view text) {
  const std::uint64_t sizes[] = {trailer.size, trailer.name_size, trailer.sender_size};
  return XXH3_64bits_withSeed(text.data(), text.size(), XXH3_64bits(sizes, sizeof sizes));
}

/// Whether it may be one of MeshLabel::key(). Nothing else may become part of a path.
bool is_key(const std::string& key) {
  if (key.size() == kIdSize) return is_content_id(key);
  return key.size() == 2 * kIdSize + 1 && key[kIdSize] == '-' && is_content_id(key.substr(0, kIdSize)) &&
         is_content_id(key.substr(kIdSize + 1));
}

/// Precondition: is_key(key).
MeshLabel label_of(const std::string& key) {
  MeshLabel label{.id = key.substr(key.size() - kIdSize)};
  if (key.size() > kIdSize) label.realm = key.substr(0, kIdSize);
  return label;
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
  std::string name, sender;
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
  const std::uint64_t most = std::min<std::uint64_t>(room, kMaxText);
  if (std::memcmp(trailer.magic, kMagic, sizeof kMagic) != 0 || trailer.name_size > most || trailer.sender_size > most ||
      trailer.size == 0 || trailer.size + trailer.name_size + trailer.sender_size != room || trailer.size > room) {
    return damaged;
  }
  std::string text(trailer.name_size + trailer.sender_size, '\0');
  if (!read_at(descriptor, trailer.size, text) || checksum_of(trailer, text) != trailer.checksum) return damaged;
  return Description{text.substr(0, trailer.name_size), text.substr(trailer.name_size), trailer.size};
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

/// Of the file in the store.
std::string name_of(const std::string& key) { return "meshes/" + key; }

std::uint64_t next_number() {
  static std::atomic<std::uint64_t> number = 0;
  return ++number;
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

/// OK where a file's bytes are those of a mesh of this id, else DataLoss.
absl::Status check_file(const std::string& path, const std::string& id) {
  const int descriptor = open_to_read(path);
  if (descriptor < 0) return absl::ErrnoToStatus(errno, absl::StrCat(path, ": cannot open"));
  const absl::Cleanup close = [descriptor] { ::close(descriptor); };
  const absl::StatusOr<Description> described = describe(descriptor, path);
  if (!described.ok()) return described.status();
  return read(descriptor, path, id, described->size, false, {}).status();
}

}  // namespace

absl::StatusOr<std::unique_ptr<MeshFolder>> MeshFolder::open(const std::string& cache, std::shared_ptr<spdlog::logger> log,
                                                             WatchedStore* store) {
  const absl::StatusOr<std::string> path = make_cache_folder(cache + "/meshes");
  if (!path.ok()) return path.status();
  const std::size_t stale = remove_stale_temporaries(*path);
  std::unique_ptr<MeshFolder> folder(new MeshFolder(*path, std::move(log), store));
  folder->log_->info("meshes {}: {} files, {} unfinished ones removed", *path, folder->list().size(), stale);
  return folder;
}

std::string MeshFolder::path_of(const std::string& key) const { return absl::StrCat(folder_, "/", key, kEnding); }

absl::StatusOr<AtomicFile> MeshFolder::create() const {
  absl::StatusOr<AtomicFile> file = AtomicFile::create_in(folder_);
  if (file.ok() || absl::IsResourceExhausted(file.status())) return file;
  return absl::UnavailableError(absl::StrCat("the server cannot keep meshes: ", file.status().message()));
}

absl::StatusOr<std::shared_ptr<const Mesh>> MeshFolder::store(AtomicFile file, const MeshLabel& label, std::size_t size) const {
  const std::string text = label.name + label.sender;
  Trailer trailer{.size = size, .name_size = label.name.size(), .sender_size = label.sender.size()};
  trailer.checksum = checksum_of(trailer, text);
  std::memcpy(trailer.magic, kMagic, sizeof kMagic);
  absl::Status status = file.write_at(size, std::as_bytes(std::span(text)));
  if (status.ok()) status = file.write_at(size + text.size(), std::as_bytes(std::span(&trailer, 1)));
  if (status.ok() && store_ != nullptr) {
    const absl::StatusOr<std::string> written = file.sync();
    status = written.ok() ? store_->put(name_of(label.key()), *written, store_->ending()) : written.status();
    if (!status.ok()) status = absl::UnavailableError(status.message());
  }
  if (status.ok()) status = file.commit_as(path_of(label.key()));
  if (status.ok()) return make_mesh(label, size);
  log_->error("meshes: {} \"{}\" is not kept: {}", label.id, printable(label.name), std::string(status.message()));
  if (absl::IsResourceExhausted(status)) return absl::ResourceExhaustedError("the server's disk is full; try again later");
  return absl::UnavailableError(absl::StrCat("the server cannot keep the mesh: ", status.message()));
}

absl::Status MeshFolder::may_store() const {
  const absl::Status state = store_ != nullptr ? store_->state() : absl::OkStatus();
  return state.ok() ? state : absl::UnavailableError(absl::StrCat("meshes cannot be taken now: ", state.message()));
}

absl::StatusOr<std::uint64_t> MeshFolder::stored_size(const std::string& key) const {
  if (store_ == nullptr || !is_key(key)) return not_found(key);
  const absl::StatusOr<std::uint64_t> size = store_->size(name_of(key), store_->ending());
  return size.ok() || absl::IsNotFound(size.status()) ? size : absl::UnavailableError(size.status().message());
}

absl::Status MeshFolder::get(const std::string& key) const {
  const std::string path = path_of(key), fetched = absl::StrCat(path, ".", next_number(), kFetched);
  const absl::Cleanup clean_up = [&] { remove_path(fetched); };
  absl::Status status = store_->get(name_of(key), fetched, store_->ending());
  if (status.ok()) status = check_file(fetched, label_of(key).id);
  if (absl::IsDataLoss(status)) {
    log_->warn("store: {}; removed", std::string(status.message()));
    store_->remove(name_of(key), store_->ending()).IgnoreError();
    return not_found(label_of(key).id);
  }
  if (absl::IsNotFound(status) || absl::IsResourceExhausted(status)) return status;
  if (!status.ok()) return absl::UnavailableError(status.message());
  std::error_code error;
  fs::rename(fetched, path, error);
  return error ? absl::UnavailableError(absl::StrCat(path, ": ", error.message())) : absl::OkStatus();
}

std::shared_ptr<const Mesh> MeshFolder::make_mesh(MeshLabel label, std::size_t size) const {
  auto load_again = [path = path_of(label.key()), id = label.id, size, log = log_](bool is_known_good,
                                                                                   const ExecutionContext& context) {
    return load(path, id, size, is_known_good, *log, context);
  };
  return std::make_shared<const Mesh>(std::move(label), size, std::move(load_again));
}

bool MeshFolder::holds(const std::string& key) const { return is_key(key) && is_file(path_of(key)); }

absl::StatusOr<std::shared_ptr<const Mesh>> MeshFolder::find(const std::string& key) const {
  if (!is_key(key)) return not_found(key);
  MeshLabel label = label_of(key);
  const std::string path = path_of(key);
  const int descriptor = open_to_read(path);
  if (descriptor < 0) return not_found(label.id);
  const absl::Cleanup close = [descriptor] { ::close(descriptor); };
  absl::StatusOr<Description> described = describe(descriptor, path);
  if (!described.ok()) {
    if (absl::IsDataLoss(described.status())) discard(*log_, path, std::string(described.status().message()));
    return not_found(label.id);
  }
  label.name = std::move(described->name);
  label.sender = std::move(described->sender);
  return make_mesh(std::move(label), described->size);
}

void MeshFolder::touch(const std::string& key) const { touch_file(path_of(key)); }

void MeshFolder::remove(const std::string& key) const { remove_path(path_of(key)); }

std::vector<MeshFolder::Stored> MeshFolder::list() const {
  std::vector<Stored> out;
  std::error_code error;
  for (fs::directory_iterator it(folder_, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    struct stat status = {};
    if (!absl::EndsWith(name, kEnding) || ::lstat(it->path().c_str(), &status) != 0 || !S_ISREG(status.st_mode)) continue;
    std::string key = name.substr(0, name.size() - std::strlen(kEnding));
    if (is_key(key)) out.push_back({std::move(key), status.st_mtim.tv_sec * 1'000'000'000 + status.st_mtim.tv_nsec});
  }
  std::ranges::sort(out, std::ranges::greater(), &Stored::last_used);
  return out;
}

}  // namespace curvecast::server
