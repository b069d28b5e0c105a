#include "server/session/mesh_folder.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <map>
#include <thread>

#include "server/base/log.h"
#include "server/session/mesh_store.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::server {
namespace {

using testing::bytes_of;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::TemporaryFolder;
using testing::write_file;
using Code = absl::StatusCode;

/// Stores on one folder, as of servers that are started one after the other, or at once.
class MeshFolderTest : public ::testing::Test {
 protected:
  std::unique_ptr<MeshStore> store(std::uint64_t max_bytes = 1 << 26, bool isolate = false) const {
    auto folder = MeshFolder::open(cache_.path(), make_logger(false, false));
    EXPECT_TRUE(folder.ok()) << folder.status();
    return std::make_unique<MeshStore>(MeshLimits{max_bytes, 1 << 25, isolate}, cache_.path(), *std::move(folder));
  }
  static absl::StatusOr<std::string> upload(MeshStore& store, const std::string& bytes, const std::string& name = "a mesh") {
    MeshUpload upload(store);
    if (absl::Status status = upload.begin(name, bytes.size(), ""); !status.ok()) return status;
    if (absl::Status status = upload.append(bytes); !status.ok()) return status;
    const auto mesh = upload.finish();
    if (!mesh.ok()) return mesh.status();
    return (*mesh)->id;
  }
  static std::string content(MeshStore& store, const std::string& id) {
    const auto mesh = store.find(id);
    if (!mesh.ok() || !(*mesh)->open().ok()) return "not found";
    return {(*mesh)->bytes().begin(), (*mesh)->bytes().end()};
  }
  std::string path_of(const std::string& id) const { return cache_ / ("meshes/" + id + ".mesh"); }
  std::vector<std::string> names() const {
    std::vector<std::string> out;
    for (const auto& entry : std::filesystem::directory_iterator(cache_ / "meshes"))
      out.push_back(entry.path().filename().string());
    return out;
  }

  TemporaryFolder cache_;
  const std::string bytes_ = std::string(100'000, 'x') + "the end";
};

TEST_F(MeshFolderTest, WhatIsStoredIsThereAfterwards) {
  const std::string id = *upload(*store(), bytes_, "a \"mesh\"\n");
  EXPECT_THAT(names(), ElementsAre(id + ".mesh")) << "and nothing else";
  const auto again = store();
  EXPECT_EQ(again->usage().meshes, 1u);
  EXPECT_GE(again->usage().bytes, bytes_.size());
  const auto mesh = again->find(id);
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_EQ((*mesh)->name, "a \"mesh\"\n");
  EXPECT_EQ((*mesh)->size(), bytes_.size());
  EXPECT_FALSE((*mesh)->is_checked());
  EXPECT_EQ(content(*again, id), bytes_);
  EXPECT_TRUE((*mesh)->is_checked());
}

TEST_F(MeshFolderTest, KeepsWhoSentWhatAndForWhom) {
  const Maker anna{.owner = "anna", .caller = "her caller"};
  const auto here = store(1 << 26, true);
  MeshUpload upload(*here, anna);
  ASSERT_TRUE(upload.begin("a mesh", bytes_.size(), "").ok());
  ASSERT_TRUE(upload.append(bytes_).ok());
  const std::string id = (*upload.finish())->id;
  const auto again = store(1 << 26, true);
  const auto mesh = again->find(id, "anna");
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_EQ((*mesh)->sender, "her caller");
  EXPECT_EQ((*mesh)->name, "a mesh");
  ASSERT_TRUE((*mesh)->open().ok());
  EXPECT_EQ(std::string((*mesh)->bytes().begin(), (*mesh)->bytes().end()), bytes_);
  EXPECT_FALSE(again->find(id, "bert").ok());
  for (const std::string& any : {id, (*mesh)->key}) {
    EXPECT_FALSE(store()->find(any).ok()) << "nor is it for all, where nobody is isolated";
  }
  EXPECT_THAT(names(), ElementsAre((*mesh)->key + ".mesh"));
}

TEST_F(MeshFolderTest, WhatIsUnderWayHasNoName) {
  const auto here = store();
  MeshUpload upload(*here);
  ASSERT_TRUE(upload.begin("a mesh", bytes_.size(), "").ok());
  ASSERT_TRUE(upload.append(bytes_.substr(0, 1000)).ok());
  const auto there = store();
  EXPECT_EQ(there->usage().meshes, 0u);
  ASSERT_TRUE(upload.append(bytes_.substr(1000)).ok()) << "another server's start takes it from nobody";
  EXPECT_TRUE(upload.finish().ok());
}

TEST_F(MeshFolderTest, StoresShareAFolder) {
  const auto here = store(), there = store();
  const std::string id = *upload(*here, bytes_);
  EXPECT_EQ(content(*there, id), bytes_);
  const auto held = there->find(id);
  std::filesystem::remove(path_of(id));
  EXPECT_EQ(here->find(id).status().code(), Code::kNotFound);
  EXPECT_EQ(content(*there, id), bytes_) << "whoever uses it has it still";
}

TEST_F(MeshFolderTest, WhatOthersStoredIsListed) {
  const auto ids = [](MeshStore& store, const std::string& after = "") {
    std::vector<std::string> out;
    for (const MeshStore::Listed& file : store.list({}, true, after, 100)) out.push_back(file.id);
    return out;
  };
  const auto first = store(), second = store();
  const std::string id = *upload(*first, bytes_, "bunny.off");
  EXPECT_THAT(ids(*second), ElementsAre(id));
  EXPECT_EQ(second->list({}, true, "", 1).at(0).name, "bunny.off");
  EXPECT_EQ(second->list({}, true, "", 1).at(0).size, bytes_.size());
  EXPECT_THAT(ids(*store()), ElementsAre(id)) << "after a restart";
  const auto apart = store(1 << 26, true);
  EXPECT_THAT(ids(*apart), IsEmpty()) << "of a server that keeps owners apart it is nobody's";
  MeshUpload of_anna(*apart, {"anna", "anna"});
  ASSERT_TRUE(of_anna.begin("hers", 3, "").ok() && of_anna.append("abc").ok() && of_anna.finish().ok());
  EXPECT_THAT(ids(*second), ElementsAre(id)) << "nor is hers of one that does not";
  EXPECT_EQ(apart->list({"anna", "anna"}, false, "", 10).size(), 1u);
  EXPECT_THAT(apart->list({"bert", "bert"}, false, "", 10), IsEmpty());
  std::filesystem::remove(path_of(id));
  EXPECT_THAT(ids(*second), IsEmpty()) << "another server made room";
}

TEST_F(MeshFolderTest, ListsWhileOthersStore) {
  // What is stored between the look into the folder and the listing stays there.
  const auto meshes = store();
  std::jthread lister([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) meshes->list({}, true, "", 1000);
  });
  for (int i = 0; i < 200; ++i) ASSERT_TRUE(upload(*meshes, "mesh " + std::to_string(i)).ok());
  lister.request_stop();
  lister.join();
  EXPECT_EQ(meshes->usage().meshes, 200u);
  EXPECT_EQ(meshes->list({}, true, "", 1000).size(), 200u);
}

TEST_F(MeshFolderTest, WhatNobodyUsesIsNotMapped) {
  const auto here = store();
  const std::string id = *upload(*here, bytes_);
  EXPECT_EQ(content(*here, id), bytes_);
  const auto held = here->find(id);
  here->run_housekeeping();
  EXPECT_EQ((*held)->bytes().size(), bytes_.size()) << "somebody does";
  const Mesh* const mesh = held->get();
  const_cast<std::shared_ptr<const Mesh>&>(*held).reset();
  here->run_housekeeping();
  EXPECT_TRUE(mesh->bytes().empty());
  EXPECT_TRUE(mesh->is_checked());
  EXPECT_EQ(content(*here, id), bytes_);
}

TEST_F(MeshFolderTest, DamagedFilesAreNoMeshes) {
  const std::string id = *upload(*store(), bytes_);
  const std::string good = bytes_of(path_of(id));
  std::string first = good, middle = good, name = good, magic = good;
  first[0] ^= 1;
  middle[bytes_.size() / 2] ^= 1;
  name[bytes_.size() + 1] ^= 1;
  magic.back() ^= 1;
  const std::map<std::string, std::string> damaged = {{"first", first},
                                                      {"middle", middle},
                                                      {"name", name},
                                                      {"magic", magic},
                                                      {"empty", ""},
                                                      {"short", good.substr(0, 1000)},
                                                      {"one less", good.substr(0, good.size() - 1)},
                                                      {"one more", good + "x"},
                                                      {"cut", good.substr(1)},
                                                      {"foreign", std::string(1000, 'y')}};
  for (const auto& [what, bytes] : damaged) {
    write_file(path_of(id), bytes);
    const auto here = store();
    EXPECT_EQ(content(*here, id), "not found") << what;
    EXPECT_FALSE(std::filesystem::exists(path_of(id))) << what;
    EXPECT_EQ(here->find(id).status().code(), Code::kNotFound) << what;
    EXPECT_EQ(*upload(*here, bytes_), id);
    EXPECT_EQ(content(*here, id), bytes_) << what;
  }
}

TEST_F(MeshFolderTest, EveryLengthOfASmallFileIsNoticed) {
  const std::string id = *upload(*store(), "abc", "n");
  const std::string good = bytes_of(path_of(id));
  for (std::size_t size = 0; size < good.size(); ++size) {
    write_file(path_of(id), good.substr(0, size));
    EXPECT_EQ(content(*store(), id), "not found") << size;
  }
  for (std::size_t at = 0; at < good.size(); ++at) {
    std::string flipped = good;
    flipped[at] = static_cast<char>(flipped[at] ^ (1 << at % 8));
    write_file(path_of(id), flipped);
    EXPECT_EQ(content(*store(), id), "not found") << at;
  }
}

TEST_F(MeshFolderTest, AFileThatBecomesShorterInUseIsAnError) {
  const auto here = store();
  const std::string id = *upload(*here, bytes_);
  const auto mesh = here->find(id);
  ASSERT_TRUE(mesh.ok() && (*mesh)->open().ok());
  EXPECT_TRUE((*mesh)->status().ok());
  ASSERT_EQ(::truncate(path_of(id).c_str(), 10), 0);
  EXPECT_EQ((*mesh)->bytes().back(), '\0');
  EXPECT_EQ((*mesh)->status().code(), Code::kDataLoss);
  EXPECT_EQ(here->find(id).status().code(), Code::kNotFound);
  EXPECT_THAT(names(), IsEmpty());
  EXPECT_EQ(*upload(*here, bytes_), id);
  EXPECT_EQ(content(*here, id), bytes_);
}

TEST_F(MeshFolderTest, TheLeastRecentlyUsedGoFirst) {
  constexpr std::uint64_t kRoom = 3 * 110'000;  // for three of them
  std::vector<std::string> ids;
  for (const char c : {'a', 'b', 'c'}) ids.push_back(*upload(*store(kRoom), std::string(100'000, c)));
  const auto here = store(kRoom), there = store(kRoom);
  EXPECT_EQ(content(*there, ids[0]), std::string(100'000, 'a')) << "used, by another server";
  const auto held = here->find(ids[1]);
  const std::string more = *upload(*here, std::string(100'000, 'd'));
  EXPECT_THAT(names(), ::testing::UnorderedElementsAre(ids[0] + ".mesh", ids[1] + ".mesh", more + ".mesh"));
  EXPECT_EQ(here->usage().meshes, 3u);
  const auto also_held = here->find(more), all_held = here->find(ids[0]);
  EXPECT_EQ(upload(*here, std::string(100'000, 'e')).status().code(), Code::kResourceExhausted) << "all are in use";
  EXPECT_EQ(names().size(), 3u);
}

TEST_F(MeshFolderTest, WithoutItsFolderNothingIsAcknowledged) {
  const auto here = store();
  std::filesystem::remove_all(cache_ / "meshes");
  EXPECT_EQ(upload(*here, bytes_).status().code(), Code::kUnavailable);
}

TEST_F(MeshFolderTest, OnlyIdsAreLookedFor) {
  const auto here = store();
  const std::string id = *upload(*here, bytes_);
  for (const std::string& other :
       {std::string(), "../meshes/" + id, id + "0", id.substr(1), std::string(32, '/'), std::string(32, 'A')}) {
    EXPECT_EQ(here->find(other).status().code(), Code::kNotFound) << other;
  }
}

}  // namespace
}  // namespace curvecast::server
