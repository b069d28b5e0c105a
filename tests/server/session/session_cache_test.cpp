#include "server/session/session_cache.h"

#include <absl/strings/str_cat.h>
#include <gmock/gmock.h>
#include <spdlog/logger.h>
#include <spdlog/sinks/ostream_sink.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <sstream>

#include "core/storage/atomic_file.h"
#include "core/storage/curve_file.h"
#include "core/storage/rank_file.h"
#include "core/storage/section_file.h"
#include "core/storage/surface_file.h"
#include "server/base/log.h"
#include "server/session/session_record.h"
#include "tests/server/eventually.h"
#include "tests/server/server_fixture.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::server {
namespace {

using testing::bytes_of;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::TemporaryFolder;
using testing::write_file;
using Code = absl::StatusCode;

std::string id_of(char digit) { return std::string(32, digit); }

Preprocessed curve_of(const std::string& off) {
  auto result = preprocess({"sphere.off", off}, {.points = 200});
  EXPECT_TRUE(result.ok()) << result.status();
  return *std::move(result);
}

const Preprocessed& some_curve() {
  static const Preprocessed made = curve_of(sphere_off(3));
  return made;
}

Session some_session(const std::string& id, const Preprocessed& curve = some_curve()) {
  Session session;
  session.id = id;
  session.mesh_id = "mesh";
  session.mesh_name = "sphere.off";
  session.owner = "anna";
  session.companions = {{"a.mtl", "1"}, {"b.png", "2"}};
  session.options = {.points = 200, .density = {CurvatureTerm{}}};
  session.preprocessed = curve;
  session.surface = std::make_shared<SessionSurface>(session.preprocessed.flattened);
  session.revisions->publish(session.preprocessed.curve);
  return session;
}

class SessionCacheTest : public ::testing::Test {
 protected:
  std::unique_ptr<SessionCache> open(std::uint64_t max_bytes = std::uint64_t{1} << 30) {
    auto cache = SessionCache::open(folder_.path(), max_bytes, log_);
    EXPECT_TRUE(cache.ok()) << cache.status();
    return *std::move(cache);
  }
  /// Saves and waits until it is done.
  void save(const Session& session, std::uint64_t max_bytes = std::uint64_t{1} << 30) {
    const auto cache = open(max_bytes);
    cache->save(session);
    cache->stop();
  }
  std::string curve_path(char digit) const { return folder_ / absl::StrCat(id_of(digit), ".v", kCurveFileVersion, ".curve"); }
  std::string refined_path(char digit) const { return folder_ / absl::StrCat(id_of(digit), ".v", kCurveFileVersion, ".refined"); }
  std::string surface_path(char digit) const {
    return folder_ / absl::StrCat(id_of(digit), ".v", kSurfaceFileVersion, ".surface");
  }

  std::string ranks_path(char digit) const { return folder_ / absl::StrCat(id_of(digit), ".v", kRankFileVersion, ".ranks"); }
  std::string grown_path(char digit) const { return folder_ / absl::StrCat(id_of(digit), ".v", kRankFileVersion, ".grown"); }
  /// A session that is saved, with more candidates than first views show.
  Session saved_and_grown(char digit, const std::vector<ChunkId>& more) {
    Session session = some_session(id_of(digit));
    EXPECT_TRUE(session.ranks({}).ok());
    const auto cache = open();
    cache->save(session);
    EXPECT_TRUE(eventually([&] { return !cache->is_unsaved(session.id); }));
    EXPECT_TRUE(session.candidates->grow(more, {}).ok());
    cache->save_candidates(session);
    cache->stop();
    return session;
  }

  TemporaryFolder folder_;
  std::ostringstream lines_;
  std::shared_ptr<spdlog::logger> log_ =
      std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(lines_));
};

TEST_F(SessionCacheTest, BringsSessionsBack) {
  const Session before = some_session(id_of('a'));
  save(before);
  const auto cache = open();
  EXPECT_TRUE(cache->holds(before.id));
  const auto after = cache->load(before.id);
  ASSERT_TRUE(after.ok()) << after.status();
  EXPECT_EQ((*after)->id, before.id);
  EXPECT_EQ((*after)->mesh_id, before.mesh_id);
  EXPECT_EQ((*after)->mesh_name, before.mesh_name);
  EXPECT_EQ((*after)->owner, before.owner);
  EXPECT_EQ(cache->owner(before.id).value_or(""), before.owner) << "told without the curve";
  EXPECT_EQ((*after)->companions, before.companions);
  EXPECT_EQ((*after)->options.points, before.options.points);
  EXPECT_EQ((*after)->options.density.size(), 1u);
  EXPECT_EQ((*after)->curve()->x, before.curve()->x);
  EXPECT_EQ((*after)->preprocessed.report.seconds.total, before.preprocessed.report.seconds.total);
  const auto surface = cache->open_surface(before.id), saved = before.curve_base();
  ASSERT_TRUE(surface.ok() && saved.ok()) << surface.status() << saved.status();
  EXPECT_TRUE(std::ranges::equal((*surface)->charts[0].uv, (*saved)->charts[0].uv));
}

TEST_F(SessionCacheTest, WhatIsNoIdIsNoFile) {
  save(some_session(id_of('a')));
  const auto cache = open();
  for (const std::string& id : {std::string(), std::string("../") + id_of('a'), id_of('A'), id_of('g'), id_of('a') + "0",
                                std::string(32, '/'), std::string(32, '\0'), id_of('b')}) {
    EXPECT_FALSE(cache->holds(id));
    EXPECT_EQ(cache->load(id).status().code(), Code::kNotFound);
    EXPECT_EQ(cache->open_surface(id).status().code(), Code::kNotFound);
    EXPECT_FALSE(cache->remove(id));
  }
}

TEST_F(SessionCacheTest, AnothersSurfaceIsNotTaken) {
  for (const char digit : {'a', 'b'}) save(some_session(id_of(digit)));
  std::filesystem::copy_file(surface_path('b'), surface_path('a'), std::filesystem::copy_options::overwrite_existing);
  const auto cache = open();
  EXPECT_EQ(cache->open_surface(id_of('a')).status().code(), Code::kDataLoss);
  EXPECT_FALSE(cache->holds(id_of('a'))) << "it is to be made anew";
  EXPECT_THAT(lines_.str(), HasSubstr("another session"));
  EXPECT_TRUE(cache->open_surface(id_of('b')).ok());
}

// Files that are sound, each by itself, as somebody who can write into the folder may put them together.
TEST_F(SessionCacheTest, CurvesThatTheirSurfaceCannotCarryAreNotTaken) {
  Session session = some_session(id_of('a'));
  const auto first = session.curve();
  save(session);
  const auto is_refused = [&](const char* reason) {
    lines_.str("");
    EXPECT_EQ(open()->load(session.id).status().code(), Code::kDataLoss) << reason;
    EXPECT_THAT(lines_.str(), HasSubstr(reason));
    EXPECT_THAT(folder_.names(), IsEmpty()) << "it is made anew";
    save(session);
    lines_.str("");
  };
  const auto smaller = curve_base(curve_of(sphere_off(1)).flattened);
  ASSERT_TRUE(smaller.ok() && save_surface(surface_path('a'), **smaller, session.id).ok());
  is_refused("a face that is not there");
  auto wrong = std::make_shared<SurfaceCurve>(*first);
  wrong->disc_begin = {0, 1, wrong->disc_begin.back()};
  wrong->key[1] = 0;  // of the second disc
  ASSERT_TRUE(save_curve(curve_path('a'), *wrong, record_of(session)).ok());
  is_refused("another surface's");

  // Of a finer curve that is wrong, the one before is left.
  wrong->revision = 2;
  ASSERT_TRUE(save_curve(refined_path('a'), *wrong, session.id).ok());
  const auto loaded = open()->load(session.id);
  ASSERT_TRUE(loaded.ok()) << loaded.status();
  EXPECT_EQ((*loaded)->curve()->revision, 1u);
  EXPECT_THAT(lines_.str(), HasSubstr("another surface's"));
}

TEST_F(SessionCacheTest, RemoveTakesAllFilesAndWaitingSaves) {
  save(some_session(id_of('a')));
  const auto cache = open();
  cache->save(some_session(id_of('a')));
  EXPECT_TRUE(cache->remove(id_of('a')));
  cache->wait_until_removed(id_of('a'));
  EXPECT_THAT(folder_.names(), ElementsAre(id_of('a') + ".closed"));
  EXPECT_FALSE(cache->remove(id_of('a')));
  cache->stop();
  EXPECT_THAT(folder_.names(), ElementsAre(id_of('a') + ".closed"));
}

TEST_F(SessionCacheTest, NoServerWritesBackWhatAnotherOneRemoved) {
  const auto here = open(), there = open();
  here->save(some_session(id_of('a')));
  here->stop();
  EXPECT_TRUE(there->remove(id_of('a')));
  save(some_session(id_of('a')));  // refined meanwhile
  EXPECT_TRUE(here->is_closed(id_of('a')));
  EXPECT_FALSE(here->holds(id_of('a')));
  EXPECT_THAT(folder_.names(), ElementsAre(id_of('a') + ".closed"));
  there->reopen(id_of('a'));
  save(some_session(id_of('a')));
  EXPECT_TRUE(here->holds(id_of('a'))) << "somebody has asked for it anew";
}

TEST_F(SessionCacheTest, MarksOfClosedSessionsGoAfterADay) {
  write_file(folder_ / (id_of('a') + ".closed"), "");
  write_file(folder_ / (id_of('b') + ".closed"), "");
  std::filesystem::last_write_time(folder_ / (id_of('a') + ".closed"),
                                   std::filesystem::file_time_type::clock::now() - std::chrono::hours(25));
  open();
  EXPECT_THAT(folder_.names(), ElementsAre(id_of('b') + ".closed"));
}

TEST_F(SessionCacheTest, ARevisionStandsBesideTheFirstCurve) {
  Session session = some_session(id_of('a'));
  save(session);
  const std::string surface = bytes_of(surface_path('a'));
  auto revised = std::make_shared<SurfaceCurve>(*session.curve());
  revised->revision = 2;
  session.revisions->publish(revised);
  session.surface = std::make_shared<SessionSurface>();  // as after a load
  save(session);
  const auto loaded = open()->load(id_of('a')).value();
  EXPECT_EQ(loaded->curve()->revision, 2u);
  EXPECT_EQ(loaded->revisions->first()->revision, 1u) << "ranked points lie on it";
  EXPECT_EQ(bytes_of(surface_path('a')), surface);
}

TEST_F(SessionCacheTest, DamagedFilesAreRemovedWithTheReason) {
  save(some_session(id_of('a')));
  const std::string good = bytes_of(curve_path('a'));
  const auto cache = open();
  const auto refused = [&](const std::string& bytes, const std::string& reason) {
    lines_.str("");
    write_file(curve_path('a'), bytes);
    EXPECT_TRUE(cache->holds(id_of('a')));
    EXPECT_FALSE(cache->load(id_of('a')).ok()) << reason;
    EXPECT_FALSE(cache->holds(id_of('a'))) << reason;
    EXPECT_THAT(lines_.str(), HasSubstr(reason));
  };
  refused("", "bytes");
  refused("not a curve at all" + std::string(100, ' '), "no file of this program");
  refused(good.substr(0, good.size() / 2), "bytes");
  std::string flipped = good;
  flipped[good.size() / 2] ^= 1;
  refused(flipped, "checksum");
  std::string newer = good;
  newer[8] = 9;
  refused(newer, "version 9");
}

TEST_F(SessionCacheTest, ACurveWithoutItsSurfaceIsRemoved) {
  const auto cache = open();
  const std::vector<std::function<void()>> losses = {[&] { write_file(surface_path('a'), "nonsense"); },
                                                     [&] { std::filesystem::remove(surface_path('a')); }};
  for (const auto& lose : losses) {
    save(some_session(id_of('a')));
    lose();
    EXPECT_TRUE(cache->holds(id_of('a')));
    EXPECT_FALSE(cache->load(id_of('a')).ok());
    EXPECT_FALSE(cache->holds(id_of('a')));
    EXPECT_THAT(folder_.names(), IsEmpty());
  }
}

TEST_F(SessionCacheTest, ADamagedChartIsFoundWhenItIsAskedFor) {
  // So large that what is damaged shares no checksum with what is read at once.
  const Session before = some_session(id_of('a'), curve_of(sphere_off(5)));
  save(before);
  const auto& positions = before.preprocessed.flattened->loaded.mesh.positions;
  std::string bytes = bytes_of(surface_path('a'));
  const std::size_t at = bytes.find(std::string(reinterpret_cast<const char*>(&positions[positions.size() / 2]), sizeof(Vec3d)));
  ASSERT_NE(at, std::string::npos);
  bytes[at] = static_cast<char>(bytes[at] ^ 1);
  write_file(surface_path('a'), bytes);
  const auto cache = open();
  const auto session = cache->load(before.id);
  ASSERT_TRUE(session.ok()) << session.status();
  EXPECT_EQ((*session)->ranks({}).status().code(), Code::kDataLoss);
  EXPECT_THAT(folder_.names(), IsEmpty()) << "it is made anew next time";
  EXPECT_THAT(lines_.str(), HasSubstr("checksum"));
}

TEST_F(SessionCacheTest, ASavedSessionTakesItsSurfaceFromTheFile) {
  const Session session = some_session(id_of('a'));
  const auto before = session.ranks({});
  ASSERT_TRUE(before.ok()) << before.status();
  const std::uint64_t bytes = session.surface->byte_size();
  EXPECT_GT(bytes, 0u);
  const std::uint64_t all = session.memory_bytes();
  std::weak_ptr<const CurveBase> in_memory = *session.curve_base();
  save(session);
  EXPECT_TRUE(in_memory.expired()) << "nobody holds it any more";
  EXPECT_EQ(session.surface->byte_size(), 0u);
  EXPECT_EQ(session.memory_bytes(), all - bytes);
  EXPECT_FALSE((*session.curve_base())->is_in_memory());
  // More ranks are the same as on the surface in memory.
  const Session other = some_session(id_of('b'));
  ASSERT_TRUE(other.ranks({}).ok());
  const std::vector<ChunkId> deeper = {{kChunkLevels + 1, 0}, {kChunkLevels + 1, 3}};
  const auto here = session.candidates->grow(deeper, {}), there = other.candidates->grow(deeper, {});
  ASSERT_TRUE(here.ok() && there.ok()) << here.status() << there.status();
  EXPECT_EQ(here->tree->points(), there->tree->points());
}

TEST_F(SessionCacheTest, FirstViewsNeedNoSurface) {
  const Session before = some_session(id_of('a'));
  const auto made = before.ranks({});
  ASSERT_TRUE(made.ok()) << made.status();
  save(before);
  ASSERT_TRUE(std::filesystem::exists(ranks_path('a')));
  const auto cache = open();
  const auto after = cache->load(before.id);
  ASSERT_TRUE(after.ok()) << after.status();
  const auto again = (*after)->ranks({});
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(again->curve, (*after)->revisions->first());
  ASSERT_EQ(again->tree->chunks().size(), made->tree->chunks().size());
  EXPECT_EQ(again->tree->chunks()[0]->x, made->tree->chunks()[0]->x);

  // Nearer views go on where the others stopped.
  const std::vector<ChunkId> deeper = {{made->tree->chunks().back()->id.level + 1, 0}};
  const auto grown = before.candidates->grow(deeper, {}), grown_again = (*after)->candidates->grow(deeper, {});
  ASSERT_TRUE(grown.ok() && grown_again.ok()) << grown.status() << grown_again.status();
  ASSERT_EQ(grown_again->tree->chunks().size(), made->tree->chunks().size() + 1);
  EXPECT_EQ(grown_again->tree->chunks().back()->x, grown->tree->chunks().back()->x);
}

TEST_F(SessionCacheTest, DamagedRanksAreMadeAnew) {
  const Session before = some_session(id_of('a'));
  ASSERT_TRUE(before.ranks({}).ok());
  save(before);
  std::string bytes = bytes_of(ranks_path('a'));
  bytes[bytes.size() / 2] ^= 1;
  write_file(ranks_path('a'), bytes);
  const auto cache = open();
  const auto after = cache->load(before.id);
  ASSERT_TRUE(after.ok()) << after.status();
  EXPECT_FALSE(std::filesystem::exists(ranks_path('a')));
  EXPECT_THAT(lines_.str(), HasSubstr("damaged"));
  EXPECT_TRUE((*after)->ranks({}).ok());
}

TEST_F(SessionCacheTest, CandidatesThatHaveGrownComeBack) {
  const int level = kChunkLevels + 1;
  const std::vector<ChunkId> more = {{level, 0}, {level, 3}, {level + 1, 1}};
  const Session before = saved_and_grown('a', more);
  const auto cache = open();
  const auto after = cache->load(before.id);
  ASSERT_TRUE(after.ok()) << after.status();
  const RankedCurve made = before.candidates->made(), again = (*after)->candidates->made();
  ASSERT_NE(again.tree, nullptr);
  ASSERT_EQ(again.tree->chunks().size(), made.tree->chunks().size());
  for (std::size_t c = 0; c < made.tree->chunks().size(); ++c) {
    EXPECT_EQ(again.tree->chunks()[c]->id, made.tree->chunks()[c]->id);
    EXPECT_EQ(again.tree->chunks()[c]->x, made.tree->chunks()[c]->x);
  }
  // They go on where they stopped, and are worth saving again only when there are many more.
  EXPECT_EQ((*after)->candidates->take_grown().tree, nullptr);
  const std::vector<ChunkId> next = {{level + 1, 2}, {level + 2, 5}};
  const auto one = before.candidates->grow(next, {}), other = (*after)->candidates->grow(next, {});
  ASSERT_TRUE(one.ok() && other.ok()) << one.status() << other.status();
  ASSERT_EQ(other->tree->chunks().size(), made.tree->chunks().size() + 2);
  EXPECT_EQ(other->tree->chunks().back()->x, one->tree->chunks().back()->x);
  EXPECT_NE((*after)->candidates->take_grown().tree, nullptr);
}

TEST_F(SessionCacheTest, OfCandidatesThatAreDamagedTheFirstOnesDo) {
  const Session before = saved_and_grown('a', {{kChunkLevels + 1, 2}});
  std::string bytes = bytes_of(grown_path('a'));
  bytes[bytes.size() / 2] ^= 1;
  write_file(grown_path('a'), bytes);
  const auto after = open()->load(before.id);
  ASSERT_TRUE(after.ok()) << after.status();
  EXPECT_FALSE(std::filesystem::exists(grown_path('a')));
  ASSERT_NE((*after)->candidates->made().tree, nullptr);
  EXPECT_EQ((*after)->candidates->made().tree->chunks().size() + 1, before.candidates->made().tree->chunks().size());
}

TEST_F(SessionCacheTest, CandidatesGoWithTheirSession) {
  Session session = saved_and_grown('a', {{kChunkLevels + 1, 0}});
  ASSERT_TRUE(std::filesystem::exists(grown_path('a')));
  const auto cache = open();
  EXPECT_TRUE(cache->remove(session.id));
  EXPECT_FALSE(std::filesystem::exists(grown_path('a')));
  ASSERT_TRUE(session.candidates->grow(std::vector<ChunkId>{{kChunkLevels + 1, 1}}, {}).ok());
  cache->save_candidates(session);
  cache->stop();
  EXPECT_FALSE(std::filesystem::exists(grown_path('a'))) << "it was closed";
}

TEST_F(SessionCacheTest, RefusesFilesThatBelongElsewhere) {
  save(some_session(id_of('a')));
  std::filesystem::copy(curve_path('a'), curve_path('b'));
  const auto cache = open();
  EXPECT_EQ(cache->load(id_of('b')).status().code(), Code::kDataLoss) << "another session's";
  ASSERT_TRUE(save_curve(curve_path('c'), *some_session("c").curve(), "no session").ok());
  EXPECT_EQ(cache->load(id_of('c')).status().code(), Code::kDataLoss);
  Session wrong = some_session(id_of('d'));
  auto curve = std::make_shared<SurfaceCurve>(*wrong.curve());
  curve->triangle[7] = 1'000'000;
  wrong.revisions = std::make_shared<CurveRevisions>();
  wrong.revisions->publish(curve);
  save(wrong);
  EXPECT_EQ(cache->load(id_of('d')).status().code(), Code::kDataLoss) << "a face that is not there";
}

TEST_F(SessionCacheTest, WithoutAGoodRevisionTheFirstOneDoes) {
  Session session = some_session(id_of('a'));
  auto revised = std::make_shared<SurfaceCurve>(*session.curve());
  revised->revision = 2;
  session.revisions->publish(revised);
  save(session);
  const std::string good = bytes_of(refined_path('a'));
  const auto cache = open();
  const auto falls_back = [&](const std::string& reason) {
    lines_.str("");
    const auto loaded = cache->load(id_of('a'));
    ASSERT_TRUE(loaded.ok()) << loaded.status();
    EXPECT_EQ((*loaded)->curve()->revision, 1u);
    EXPECT_FALSE(std::filesystem::exists(refined_path('a')));
    EXPECT_THAT(lines_.str(), HasSubstr(reason));
  };
  write_file(refined_path('a'), good.substr(0, good.size() / 2));
  falls_back("bytes");
  ASSERT_TRUE(save_curve(refined_path('a'), *revised, id_of('b')).ok());
  falls_back("of another session");
  revised->triangle[7] = 1'000'000;
  ASSERT_TRUE(save_curve(refined_path('a'), *revised, id_of('a')).ok());
  falls_back("a face that is not there");
}

TEST_F(SessionCacheTest, TheLeastRecentlyUsedGoFirst) {
  save(some_session(id_of('a')));
  const std::uint64_t each = bytes_of(curve_path('a')).size() + bytes_of(surface_path('a')).size();
  save(some_session(id_of('b')));
  write_file(folder_ / "somebody's.curve", std::string(each, 'x'));  // neither counted nor removed
  write_file(folder_ / (id_of('f') + ".v0.curve"), std::string(100, 'x'));
  const auto set_age = [&](const std::string& path, int hours) {
    std::filesystem::last_write_time(path, std::filesystem::file_time_type::clock::now() - std::chrono::hours(hours));
  };
  for (const std::string& path : {curve_path('a'), surface_path('a')}) set_age(path, 3);
  for (const std::string& path : {curve_path('b'), surface_path('b')}) set_age(path, 2);
  set_age(folder_ / (id_of('f') + ".v0.curve"), 4);
  ASSERT_TRUE(open()->load(id_of('a')).ok());  // used now
  save(some_session(id_of('c')), 2 * each + each / 2);
  const auto cache = open();
  EXPECT_TRUE(cache->holds(id_of('a')));
  EXPECT_FALSE(cache->holds(id_of('b')));
  EXPECT_TRUE(cache->holds(id_of('c')));
  EXPECT_FALSE(std::filesystem::exists(surface_path('b')));
  EXPECT_FALSE(std::filesystem::exists(folder_ / (id_of('f') + ".v0.curve"))) << "old versions go in their turn";
  EXPECT_TRUE(std::filesystem::exists(folder_ / "somebody's.curve"));
}

TEST_F(SessionCacheTest, WhatIsTooLargeIsNotSaved) {
  save(some_session(id_of('a')), 1000);
  EXPECT_THAT(folder_.names(), IsEmpty());
  EXPECT_THAT(lines_.str(), HasSubstr("not cached"));
}

TEST_F(SessionCacheTest, AFolderThatFailsIsLoggedOnce) {
  const auto cache = open();
  std::filesystem::remove_all(folder_.path());
  for (const char digit : {'a', 'b', 'c'}) cache->save(some_session(id_of(digit)));
  cache->stop();
  const std::string lines = lines_.str();
  const std::size_t first = lines.find("is not cached");
  ASSERT_NE(first, std::string::npos) << lines;
  EXPECT_EQ(lines.find("is not cached", first + 1), std::string::npos) << lines;
  EXPECT_FALSE(cache->holds(id_of('a')));
}

TEST_F(SessionCacheTest, UnusableFoldersAreRefused) {
  write_file(folder_ / "file", "");
  for (const std::string& path : {folder_ / "file", folder_ / "file/below", std::string("/proc/nowhere/cache")}) {
    const auto cache = SessionCache::open(path, 1, log_);
    EXPECT_EQ(cache.status().code(), Code::kFailedPrecondition);
    EXPECT_THAT(std::string(cache.status().message()), HasSubstr(path));
  }
}

TEST_F(SessionCacheTest, MakesItsFolderForItsOwnerOnly) {
  for (const std::string& path : {folder_ / "new/cache", folder_ / "other/"}) {
    ASSERT_TRUE(SessionCache::open(path, 1, log_).ok());
    struct stat status = {};
    ASSERT_EQ(::stat(path.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777, 0700u);
  }
}

TEST_F(SessionCacheTest, RemovesOnlyTheTemporariesOfTheDead) {
  write_file(curve_path('a') + ".x1y2z3.curvecast-tmp", "half a curve");
  absl::StatusOr<AtomicFile> being_written = AtomicFile::create(curve_path('b'));
  ASSERT_TRUE(being_written.ok());
  open();
  ASSERT_EQ(folder_.names().size(), 1u);
  EXPECT_THAT(folder_.names()[0], EndsWith(".curvecast-tmp"));
  EXPECT_TRUE(being_written->commit().ok());
}

}  // namespace
}  // namespace curvecast::server
