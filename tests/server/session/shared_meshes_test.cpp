// Servers with a folder of meshes each and one store.
#include <gmock/gmock.h>

#include <filesystem>
#include <memory>
#include <string>

#include "server/base/log.h"
#include "server/session/mesh_folder.h"
#include "server/session/mesh_store.h"
#include "tests/server/eventually.h"
#include "tests/server/store/fake_store.h"

namespace curvecast::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::TemporaryFolder;
using Code = absl::StatusCode;

/// A server's meshes in front of a store that all share.
struct MeshReplica {
  MeshReplica(const std::shared_ptr<FakeFiles>& files, std::uint64_t max_bytes = 1 << 26, bool isolate = false)
      : store("fake://", std::make_unique<FakeStore>(files), make_logger(false, false), std::chrono::milliseconds(5)),
        meshes({max_bytes, 1 << 25, isolate}, folder.path(),
               MeshFolder::open(folder.path(), make_logger(false, false), &store).value()) {}

  absl::StatusOr<std::string> upload(const std::string& bytes, const Maker& maker = {}) {
    MeshUpload upload(meshes, maker);
    if (absl::Status status = upload.begin("a mesh", bytes.size(), ""); !status.ok()) return status;
    if (absl::Status status = upload.append(bytes); !status.ok()) return status;
    const auto mesh = upload.finish();
    if (!mesh.ok()) return mesh.status();
    return (*mesh)->id;
  }
  std::string content(const std::string& id, const std::string& who = "") {
    const auto mesh = meshes.find(id, who);
    if (!mesh.ok()) return std::string(mesh.status().message());
    if (absl::Status opened = (*mesh)->open(); !opened.ok()) return std::string(opened.message());
    return {(*mesh)->bytes().begin(), (*mesh)->bytes().end()};
  }
  std::vector<std::string> names() const {
    std::vector<std::string> out;
    for (const auto& entry : std::filesystem::directory_iterator(folder / "meshes"))
      out.push_back(entry.path().filename().string());
    return out;
  }

  TemporaryFolder folder;
  WatchedStore store;
  MeshStore meshes;
};

class SharedMeshesTest : public ::testing::Test {
 protected:
  const std::shared_ptr<FakeFiles> files_ = std::make_shared<FakeFiles>();
  MeshReplica a_{files_}, b_{files_};
  const std::string bytes_ = std::string(100'000, 'x') + "the end";
};

TEST_F(SharedMeshesTest, OneServersUploadIsAnothersMesh) {
  const auto id = a_.upload(bytes_);
  ASSERT_TRUE(id.ok()) << id.status();
  EXPECT_THAT(files_->names(), ElementsAre("meshes/" + *id)) << "it was acknowledged";
  EXPECT_EQ(b_.content(*id), bytes_);
  EXPECT_EQ(b_.meshes.find(*id).value()->name, "a mesh");
  EXPECT_THAT(b_.names(), ElementsAre(*id + ".mesh"));
  EXPECT_EQ(b_.meshes.usage().meshes, 1u);
  const int calls = files_->calls();
  EXPECT_EQ(b_.content(*id), bytes_);
  EXPECT_EQ(files_->calls(), calls) << "it is here now";
}

TEST_F(SharedMeshesTest, AnUploadThatTheStoreDoesNotTakeIsNone) {
  files_->fail(absl::ResourceExhaustedError("the bucket is full"));
  const auto refused = a_.upload(bytes_);
  EXPECT_EQ(refused.status().code(), Code::kUnavailable);
  EXPECT_THAT(refused.status().message(), HasSubstr("the bucket is full"));
  EXPECT_THAT(a_.names(), IsEmpty()) << "nor does it count as held later";
  files_->fail(absl::OkStatus());
  EXPECT_TRUE(a_.upload(bytes_).ok());
}

TEST_F(SharedMeshesTest, WhileTheStoreIsAwayNoneIsTakenAndHeldOnesGoOn) {
  const std::string id = a_.upload(bytes_).value();
  files_->fail(absl::UnavailableError("no route"));
  EXPECT_EQ(b_.meshes.find(id).status().code(), Code::kUnavailable) << "it may be there";
  EXPECT_EQ(a_.content(id), bytes_);
  a_.store.size("x", nullptr).IgnoreError();
  MeshUpload upload(a_.meshes);
  const absl::Status refused = upload.begin("other", 3, "");
  EXPECT_EQ(refused.code(), Code::kUnavailable) << "before the bytes are sent";
  EXPECT_THAT(refused.message(), HasSubstr("no route"));
  files_->fail(absl::OkStatus());
  EXPECT_TRUE(eventually([&] { return b_.content(id) == bytes_; }));
}

TEST_F(SharedMeshesTest, WhatIsDamagedInTheStoreIsRemovedThere) {
  const std::string id = a_.upload(bytes_).value(), name = "meshes/" + id;
  const std::string good = files_->get().at(name);
  std::string flipped = good;
  flipped[good.size() / 2] ^= 1;
  const std::string other = a_.upload("other").value();
  for (const std::string& bad : {flipped, good.substr(0, good.size() / 2), std::string(), files_->get().at("meshes/" + other)}) {
    files_->set(name, bad);
    EXPECT_EQ(b_.meshes.find(id).status().code(), Code::kNotFound);
    EXPECT_FALSE(files_->has(name));
    EXPECT_THAT(b_.names(), IsEmpty());
  }
  EXPECT_TRUE(a_.upload(bytes_).ok()) << "it is held there, and put again";
  EXPECT_EQ(b_.content(id), bytes_);
}

TEST_F(SharedMeshesTest, WhatIsDamagedHereIsGotAgain) {
  const std::string id = a_.upload(bytes_).value();
  std::filesystem::remove(a_.folder / ("meshes/" + id + ".mesh"));
  EXPECT_EQ(a_.content(id), bytes_);
}

TEST_F(SharedMeshesTest, WhatMakesRoomStaysInTheStore) {
  MeshReplica small(files_, 250'000);
  const std::string first = small.upload(bytes_).value(), second = small.upload(bytes_ + "2").value();
  const std::string third = small.upload(bytes_ + "3").value();
  EXPECT_EQ(small.meshes.usage().meshes, 2u);
  for (const std::string& id : {first, second, third, first}) EXPECT_THAT(small.content(id), HasSubstr("the end"));
  EXPECT_LE(small.meshes.usage().bytes, 250'000u);
  EXPECT_EQ(files_->names().size(), 3u);
}

TEST_F(SharedMeshesTest, OwnersAreIsolatedThereToo) {
  MeshReplica a(files_, 1 << 26, true), b(files_, 1 << 26, true);
  const std::string id = a.upload(bytes_, {.owner = "anna"}).value();
  EXPECT_EQ(b.content(id, "anna"), bytes_);
  EXPECT_EQ(b.meshes.find(id, "berta").status().code(), Code::kNotFound);
}

}  // namespace
}  // namespace curvecast::server
