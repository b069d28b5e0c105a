// What servers find in the folder of their cache: files of sessions and of meshes that others have written, or that are cut short
// while they are in use. Everything else in the folder is good. Of an input
//   1 byte    whose bits say which file it is (0 to 2), whether the bytes take its place or change a good one (3), whether the
//             checksums are made right afterwards (4), whether it is cut short while it is used (5), whether ranks are grown (6)
//             and the curve refined (7)
//   2 bytes   where it is cut, in 65536ths of its length; odd: only after the first points were taken
//   the rest  the file, or changes of a good one, one after the other: 3 bytes where, one for what (see change()), and new bytes
// Half of all inputs have right checksums, so that they hide nothing of the code behind them, and no check is left out there.
#include <absl/strings/match.h>
#include <spdlog/logger.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/pipeline/curve_surface.h"
#include "core/refine/refine.h"
#include "server/base/log.h"
#include "server/frame/pack_points.h"
#include "server/frame/session_sampler.h"
#include "server/session/cache_folder.h"
#include "server/session/mesh_folder.h"
#include "server/session/session_cache.h"
#include "tests/fuzz/fuzz_bytes.h"
#include "tests/fuzz/fuzz_expect.h"
#include "tests/fuzz/fuzz_folder.h"
#include "tests/fuzz/fuzz_input.h"
#include "tests/fuzz/section_sums.h"

namespace curvecast::fuzzing {
namespace {

namespace fs = std::filesystem;

constexpr char kMesh[] =
    "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n"
    "property uchar green\nproperty uchar blue\nproperty float heat\nelement face 7\nproperty list uchar int vertex_indices\n"
    "end_header\n1 0 0 255 0 0 1\n0 1 0 0 255 0 2\n-1 0 0 0 0 255 3\n0 -1 0 9 9 9 4\n0 0 1 0 0 0 5\n0 0 -1 255 255 255 6\n"
    "3 0 1 4\n3 1 2 4\n3 2 3 4\n3 3 0 4\n3 1 0 5\n3 2 1 5\n3 3 2 5\n";
constexpr std::uint64_t kPoints = 64, kMorePoints = 1500;  // the first ranks are 1,024
constexpr std::uint64_t kMostVertices = 4000;              // of a finer curve
constexpr std::uint64_t kCacheBytes = std::uint64_t{1} << 30;

/// Errors of files that are not what they should be; all else would be a server's own.
bool blames_the_file(const absl::Status& status) {
  return absl::IsDataLoss(status) || absl::IsNotFound(status) || absl::IsFailedPrecondition(status) ||
         absl::IsInvalidArgument(status) || absl::IsUnavailable(status);
}

void expect_good_or_blamed(const absl::Status& status) { expect(status.ok() || blames_the_file(status), status.ToString()); }

/// With a curve, a finer one, a surface, ranks.
server::Session make_session(const std::string& id) {
  auto made = preprocess({"a.ply", std::string(kMesh)}, {.points = kPoints, .omega = 2});
  expect(made.ok(), made.status().ToString());
  server::Session session;
  session.id = id;
  session.mesh_id = id;
  session.mesh_name = "a.ply";
  session.owner = "anna";
  session.companions = {{"a.mtl", id}};
  session.options = {.points = kPoints, .omega = 2, .density = {CurvatureTerm{}, BrushTerm{{Dab{}}}}};
  session.preprocessed = *std::move(made);
  session.surface = std::make_shared<server::SessionSurface>(session.preprocessed.flattened);
  session.revisions->publish(session.preprocessed.curve);
  const auto base = session.curve_base();
  expect(base.ok(), base.status().ToString());
  const CurveDemand demand{.points = 4 * kPoints, .density = {}};
  const auto finer = refine(**base, *session.curve(), std::span(&demand, 1), {.omega = 2, .max_vertices = kMostVertices});
  expect(finer.ok() && finer->curve != nullptr, finer.status().ToString());
  expect(session.ranks({}).ok(), "no ranks");
  session.revisions->publish(finer->curve);
  return session;
}

/// The folder, with a session and a mesh in it.
class Cache {
 public:
  Cache() {
    cache_ = open();
    cache_->save(make_session(id_));
    cache_->stop();
    cache_ = open();
    auto meshes = server::MeshFolder::open(folder_.path(), log_);
    expect(meshes.ok(), meshes.status().ToString());
    meshes_ = *std::move(meshes);
    server::Hasher hasher;
    hasher.update(kMesh);
    mesh_id_ = hasher.hex();
    absl::StatusOr<AtomicFile> file = meshes_->create();
    expect(file.ok() && file->write_at(0, std::as_bytes(std::span(kMesh, sizeof kMesh - 1))).ok(), "a mesh cannot be written");
    expect(meshes_->store(*std::move(file), {.id = mesh_id_, .name = "a.ply", .sender = "anna"}, sizeof kMesh - 1).ok(),
           "a mesh cannot be stored");
    const server::CacheFolder folder(folder_.path());
    for (const std::string& path : folder.paths(id_)) paths_.push_back(path);
    paths_.push_back(mesh_path(mesh_id_));
    for (std::size_t i = 0; i < paths_.size(); ++i) {
      good_.push_back(bytes_of(paths_[i]));
      expect(!good_.back().empty(), "nothing is saved as " + paths_[i]);
      fs::rename(paths_[i], spare(i));
    }
    put_back();
  }

  std::size_t files() const { return paths_.size(); }
  bool is_mesh(std::size_t file) const { return file + 1 == paths_.size(); }
  const std::string& good(std::size_t file) const { return good_[file]; }
  const std::string& path(std::size_t file) const { return paths_[file]; }
  const std::string& session_id() const { return id_; }
  const std::string& mesh_id() const { return mesh_id_; }
  std::string mesh_path(const std::string& id) const { return folder_ / ("meshes/" + id + ".mesh"); }
  server::SessionCache& sessions() { return *cache_; }
  server::MeshFolder& meshes() { return *meshes_; }

  /// All files are good ones again: names of files that nobody writes to.
  void put_back() const {
    for (std::size_t i = 0; i < paths_.size(); ++i) {
      ::unlink(paths_[i].c_str());
      fs::create_hard_link(spare(i), paths_[i]);
    }
  }

 private:
  std::string spare(std::size_t file) const { return folder_ / ("good " + std::to_string(file)); }
  std::unique_ptr<server::SessionCache> open() const {
    auto cache = server::SessionCache::open(folder_.path(), kCacheBytes, log_);
    expect(cache.ok(), cache.status().ToString());
    return *std::move(cache);
  }

  Folder folder_;
  const std::shared_ptr<spdlog::logger> log_ = server::make_logger(false, false);
  const std::string id_ = std::string(32, 'a');
  std::string mesh_id_;
  std::vector<std::string> paths_;  // those of CacheFolder::paths(), and the mesh's
  std::vector<std::string> good_;   // their bytes
  std::unique_ptr<server::SessionCache> cache_;
  std::unique_ptr<server::MeshFolder> meshes_;
};

/// Made before the first input.
std::unique_ptr<Cache> the_cache;

/// `what`: so many new bytes in place of old ones or, from kInsert on, between them; 0: the file ends there.
void change(std::string& file, std::size_t offset, std::uint8_t what, Bytes& bytes) {
  constexpr std::uint8_t kInsert = 192;
  offset = file.empty() ? 0 : offset % file.size();
  if (what == 0) return file.resize(offset);
  const std::string_view some = bytes.take_text(what < kInsert ? what : what - kInsert);
  if (what >= kInsert) {
    file.insert(offset, some);
  } else {
    file.replace(offset, some.size(), some);
  }
}

std::string changed(std::string file, Bytes& bytes) {
  while (!bytes.empty()) {
    const std::size_t offset = bytes.take<std::uint16_t>() + (std::size_t{bytes.take()} << 16);
    change(file, offset, bytes.take(), bytes);
  }
  return file;
}

struct Uses {
  bool grows = false, refines = false;
};

struct Cut {
  double part = 1;  // of the file's length; 1: it is not cut
  bool is_late = false;
};

/// As views and calls do: points of both samplers, with all that is known of the surface, packed.
absl::Status sample(const server::Session& session, server::Sampler sampler, std::uint64_t points) {
  server::PointSetRequest request{.sampler = sampler, .options = {.points = points}, .draco = DracoOptions{}};
  request.attributes = {.curvatures = true, .rank = true, .surface = true, .directions = true, .scalars = true};
  request.attributes.rank = sampler == server::Sampler::kProgressive;
  server::ViewCache views;
  absl::StatusOr<server::Sampled> sampled = sample_points(session, request, views, {.threads = 1});
  if (!sampled.ok()) return sampled.status();
  expect(sampled->points().size() <= points, "more points than were asked for");
  return pack(*std::move(sampled), request).status();
}

void use(const server::Session& session, const Uses& uses) {
  static DearWork growing;
  if (uses.grows && growing.is_due()) {
    expect_good_or_blamed(growing.run([&] { return sample(session, server::Sampler::kProgressive, kMorePoints); }));
  } else if (session.candidates->made().tree != nullptr) {  // else they would have to be made, which is as dear
    expect_good_or_blamed(sample(session, server::Sampler::kProgressive, kPoints));
  }
  const auto base = session.curve_base();
  expect_good_or_blamed(base.status());
  if (!base.ok()) return;
  static_cast<void>((*base)->is_all_sound());
  if (!uses.refines) return;
  const CurveDemand demand{.points = 8 * kPoints, .density = {}};
  const auto finer =
      refine(**base, *session.curve(), std::span(&demand, 1), {.omega = 2, .max_vertices = kMostVertices}, {.threads = 1});
  expect_good_or_blamed(finer.status());
}

/// Cuts a file that somebody may have mapped.
void shorten(const std::string& path, double part) {
  std::error_code ignored;
  const auto size = static_cast<double>(fs::file_size(path, ignored));
  if (!ignored) fs::resize_file(path, static_cast<std::uintmax_t>(part * size), ignored);
}

void take_session(Cache& cache, const std::string& path, const Cut& cut, const Uses& uses) {
  const auto owner = cache.sessions().owner(cache.session_id());
  expect_good_or_blamed(owner.status());
  const auto session = cache.sessions().load(cache.session_id());
  expect_good_or_blamed(session.status());
  if (!session.ok()) return;
  const bool is_cut = cut.part < 1 && fs::exists(path);
  if (is_cut && !cut.is_late) shorten(path, cut.part);
  expect_good_or_blamed(sample(**session, server::Sampler::kEqualised, kPoints));
  if (is_cut && cut.is_late) shorten(path, cut.part);
  use(**session, uses);
  // Ranks are copied, and the other files mapped.
  if (is_cut && fs::exists(path) && !absl::EndsWith(path, ".ranks")) {
    expect(absl::IsDataLoss((*session)->status()), "nobody notices that a file is cut");
  }
}

void take_mesh(Cache& cache, const std::string& id, const Cut& cut) {
  const auto mesh = cache.meshes().find(id);
  expect_good_or_blamed(mesh.status());
  if (!mesh.ok()) return;
  expect_good_or_blamed((*mesh)->open());
  if (!(*mesh)->is_checked()) return;
  if (cut.part < 1) shorten(cache.mesh_path(id), cut.part);
  unsigned sum = 0;
  for (const char c : (*mesh)->bytes()) sum += static_cast<unsigned char>(c);
  expect((*mesh)->bytes().size() == (*mesh)->size() && sum < ~0U, "another size");
  expect_good_or_blamed((*mesh)->status());
}

}  // namespace

void take_input(const std::uint8_t* data, std::size_t size) {
  Cache& cache = *the_cache;
  Bytes bytes(data, size);
  const std::uint8_t bits = bytes.take();
  const auto is_set = [bits](int bit) { return (bits >> bit & 1) != 0; };
  const std::size_t number = bits % 8 % cache.files();
  const std::uint16_t where = bytes.take<std::uint16_t>();
  std::string file = is_set(3) ? std::string(bytes.take_all()) : changed(cache.good(number), bytes);
  const Cut cut = {.part = is_set(5) ? where / 65536.0 : 1, .is_late = where % 2 != 0};
  if (cache.is_mesh(number)) {
    std::string id = cache.mesh_id();
    if (is_set(4)) id = mend_mesh_file(file);
    ::unlink(cache.mesh_path(id).c_str());
    write_file(cache.mesh_path(id), file);
    take_mesh(cache, id, cut);
    ::unlink(cache.mesh_path(id).c_str());
  } else {
    if (is_set(4)) mend_section_file(file);
    ::unlink(cache.path(number).c_str());
    write_file(cache.path(number), file);
    take_session(cache, cache.path(number), cut, {.grows = is_set(6), .refines = is_set(7)});
  }
  cache.put_back();
}

}  // namespace curvecast::fuzzing

extern "C" int LLVMFuzzerInitialize(int* /*argc*/, char*** /*argv*/) {
  static const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);  // the same every time
  curvecast::fuzzing::the_cache = std::make_unique<curvecast::fuzzing::Cache>();
  return 0;
}
