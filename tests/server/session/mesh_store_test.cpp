#include "server/session/mesh_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;

absl::StatusOr<std::shared_ptr<const Mesh>> upload(MeshStore& store, std::string_view bytes, std::string_view expected_id = "",
                                                   std::size_t chunk = 1000, const Maker& maker = {}) {
  MeshUpload upload(store, maker);
  if (auto status = upload.begin("a mesh", bytes.size(), expected_id); !status.ok()) return status;
  for (std::size_t at = 0; at < bytes.size(); at += chunk) {
    if (auto status = upload.append(bytes.substr(at, chunk)); !status.ok()) return status;
  }
  return upload.finish();
}

std::string pattern(std::size_t size, int seed) {
  std::string bytes(size, '\0');
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<char>((i * 7919 + seed * 104729) >> 3);
  return bytes;
}

TEST(MeshStore, KeepsTheBytesUnderTheirHash) {
  MeshStore store({1 << 26, 1 << 25});
  const std::string bytes = pattern(3'333'333, 1);
  const auto mesh = upload(store, bytes);
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_EQ((*mesh)->id.size(), 32u);
  EXPECT_EQ(std::string((*mesh)->bytes().begin(), (*mesh)->bytes().end()), bytes);
  const auto found = store.find((*mesh)->id);
  ASSERT_TRUE(found.ok());
  EXPECT_EQ(*found, *mesh);
}

TEST(MeshStore, HashesAsSha256sumDoes) {
  MeshStore store({1 << 20, 1 << 20});
  const auto mesh = upload(store, "abc");
  ASSERT_TRUE(mesh.ok());
  EXPECT_EQ((*mesh)->id, "ba7816bf8f01cfea414140de5dae2223");  // printf abc | sha256sum
}

TEST(MeshStore, SameBytesInOtherChunksAreTheSameMesh) {
  MeshStore store({1 << 24, 1 << 20});
  const std::string bytes = pattern(10'000, 2);
  const auto first = upload(store, bytes, "", 1);
  const auto second = upload(store, bytes, (*first)->id, 4096);
  ASSERT_TRUE(second.ok()) << second.status();
  EXPECT_EQ(*first, *second);
}

TEST(MeshStore, RefusesWhatTheHeaderDoesNotMatch) {
  MeshStore store({1 << 24, 1 << 20});
  EXPECT_THAT(upload(store, "").status().message(), HasSubstr("empty"));
  EXPECT_THAT(upload(store, "abc", "00000000000000000000000000000000").status().message(), HasSubstr("hash"));
  {
    MeshUpload longer(store);
    ASSERT_TRUE(longer.begin("", 3, "").ok());
    EXPECT_EQ(longer.append("abcd").code(), absl::StatusCode::kInvalidArgument);
  }
  {
    MeshUpload shorter(store);
    ASSERT_TRUE(shorter.begin("", 3, "").ok());
    ASSERT_TRUE(shorter.append("ab").ok());
    EXPECT_EQ(shorter.finish().status().code(), absl::StatusCode::kInvalidArgument);
  }
  MeshUpload named(store);
  EXPECT_EQ(named.begin(std::string(5000, 'x'), 3, "").code(), absl::StatusCode::kInvalidArgument);
}

TEST(MeshStore, RefusesLargeFilesByTheirHeader) {
  MeshStore store({1 << 24, 1000});
  MeshUpload upload(store);
  EXPECT_EQ(upload.begin("", 1001, "").code(), absl::StatusCode::kResourceExhausted);
}

TEST(MeshStore, EvictsTheLeastRecentlyUsedThatNobodyHolds) {
  MeshStore store({3'300'000, 1 << 20});
  const std::string ids[] = {(*upload(store, pattern(1'000'000, 1)))->id, (*upload(store, pattern(1'000'000, 2)))->id,
                             (*upload(store, pattern(1'000'000, 3)))->id};
  const auto held = store.find(ids[0]);
  ASSERT_TRUE(store.find(ids[1]).ok());  // now 2 is the oldest, but for the one held
  ASSERT_TRUE(upload(store, pattern(1'000'000, 4)).ok());
  EXPECT_TRUE(store.find(ids[0]).ok());
  EXPECT_TRUE(store.find(ids[1]).ok());
  EXPECT_EQ(store.find(ids[2]).status().code(), absl::StatusCode::kNotFound);
}

TEST(MeshStore, CountsUploadsUnderWay) {
  MeshStore store({2'500'000, 2'000'000});
  const std::string bytes = pattern(2'000'000, 1);
  {
    MeshUpload first(store);
    ASSERT_TRUE(first.begin("", bytes.size(), "").ok());
    ASSERT_TRUE(first.append(bytes).ok());
    EXPECT_EQ(upload(store, bytes).status().code(), absl::StatusCode::kResourceExhausted);
  }
  EXPECT_TRUE(upload(store, bytes).ok());  // the room came back
}

absl::StatusOr<std::shared_ptr<const Mesh>> upload_as(MeshStore& store, const std::string& who, std::string_view bytes) {
  return upload(store, bytes, "", 1'000'000, {who, who});
}

TEST(MeshStore, WhoHoldsMoreThanHisShareMakesRoom) {
  MeshStore store({10'300'000, 2'000'000});
  const std::string of_anna = (*upload_as(store, "anna", pattern(1'000'000, 1)))->id;
  std::vector<std::string> of_bert;
  for (int i = 0; i < 9; ++i) of_bert.push_back((*upload_as(store, "bert", pattern(1'000'000, 10 + i)))->id);
  // The store is full: whoever asks, what bert has beyond his half goes, the oldest first; what he uses stays.
  const auto used = store.find(of_bert[0]);
  const std::string another = (*upload_as(store, "anna", pattern(1'000'000, 2)))->id;
  EXPECT_FALSE(store.find(of_bert[1]).ok());
  EXPECT_TRUE(upload_as(store, "bert", pattern(1'000'000, 30)).ok());
  EXPECT_FALSE(store.find(of_bert[2]).ok());
  EXPECT_EQ(store.usage().evicted, 2u);
  for (const std::string& id : {of_anna, another, of_bert[0], of_bert[3]}) EXPECT_TRUE(store.find(id).ok()) << id;
}

TEST(MeshStore, WhoIsBeyondHisSharePushesNobodyOut) {
  MeshStore store({10'300'000, 10'000'000});
  const std::string of_anna = (*upload_as(store, "anna", pattern(1'000'000, 1)))->id;
  std::vector<std::shared_ptr<const Mesh>> used;
  for (int i = 0; i < 9; ++i) used.push_back(*upload_as(store, "bert", pattern(1'000'000, 10 + i)));
  EXPECT_TRUE(absl::IsResourceExhausted(upload_as(store, "bert", pattern(1'000'000, 30)).status()));
  EXPECT_TRUE(store.find(of_anna).ok());
  used.pop_back();
  EXPECT_TRUE(upload_as(store, "bert", pattern(1'000'000, 30)).ok()) << "at the expense of his own";
  EXPECT_TRUE(store.find(of_anna).ok());
}

TEST(MeshStore, UploadsUnderWayLeaveRoomForOthers) {
  MeshStore store({8'300'000, 1'000'000});
  std::vector<std::unique_ptr<MeshUpload>> under_way;
  absl::Status status;
  for (int i = 0; i < 8 && status.ok(); ++i) {
    under_way.push_back(std::make_unique<MeshUpload>(store, Maker{"bert", "bert"}));
    status = under_way.back()->begin("", 1'000'000, "");
    if (status.ok()) status = under_way.back()->append(pattern(999'999, i));
  }
  EXPECT_TRUE(absl::IsResourceExhausted(status)) << status;
  EXPECT_EQ(under_way.size(), 5u) << "four of them are half of the store";
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(upload_as(store, "anna", pattern(1'000'000, 10 + i)).ok());
  under_way.clear();
  EXPECT_EQ(store.usage().bytes, 3u * (1'000'000 + 4096)) << "all of it came back";
}

TEST(MeshStore, IsolatedOwnersFindTheirOwn) {
  MeshStore store({1 << 26, 1 << 25, true});
  const auto of_anna = *upload_as(store, "anna", "abc");
  EXPECT_FALSE(store.find(of_anna->id, "bert").ok());
  EXPECT_FALSE(store.find(of_anna->id).ok());
  const auto of_bert = *upload_as(store, "bert", "abc");
  EXPECT_EQ(of_anna->id, of_bert->id);
  EXPECT_NE(of_anna->key, of_bert->key);
  EXPECT_EQ(*store.find(of_anna->id, "anna"), of_anna);
  EXPECT_EQ(*store.find(of_bert->id, "bert"), of_bert);
  EXPECT_EQ(store.usage().meshes, 2u);
}

TEST(MeshStore, TheSizeMayTurnOutAtTheEnd) {
  curvecast::testing::TemporaryFolder folder;
  for (const std::string& path : {std::string(), folder.path()}) {
    MeshStore store({1 << 26, 3'000'000}, path);
    const std::string bytes = pattern(2'500'000, 1);
    MeshUpload upload(store, {"anna", "anna"});
    ASSERT_TRUE(upload.begin_unsized("a mesh", "").ok());
    for (std::size_t at = 0; at < bytes.size(); at += 100'000) ASSERT_TRUE(upload.append(bytes.substr(at, 100'000)).ok());
    ASSERT_TRUE(upload.append("").ok());
    EXPECT_TRUE(absl::IsInvalidArgument(upload.append("more")));
    const auto mesh = upload.finish();
    ASSERT_TRUE(mesh.ok()) << mesh.status();
    EXPECT_TRUE(std::ranges::equal((*mesh)->bytes(), bytes));
    EXPECT_EQ((*mesh)->size(), bytes.size());
    EXPECT_EQ(store.usage().bytes, bytes.size() + 4096) << "what was reserved ahead came back";
  }
}

TEST(MeshStore, WithoutASizeTheLimitHoldsWhileBytesCome) {
  MeshStore store({1 << 26, 1'000'000});
  {
    MeshUpload upload(store);
    ASSERT_TRUE(upload.begin_unsized("a mesh", "").ok());
    ASSERT_TRUE(upload.append(pattern(1'000'000, 1)).ok());
    EXPECT_LE(store.usage().bytes, 1'000'000u + 4096) << "nothing beyond it is reserved";
    const absl::Status status = upload.append("x");
    EXPECT_TRUE(absl::IsResourceExhausted(status)) << status;
    EXPECT_THAT(status.message(), HasSubstr("1000000"));
  }
  {
    MeshUpload empty(store);
    ASSERT_TRUE(empty.begin_unsized("a mesh", "").ok());
    ASSERT_TRUE(empty.append("").ok());
    EXPECT_TRUE(absl::IsInvalidArgument(empty.finish().status()));
  }
  const std::string id(32, '0');
  {
    MeshUpload wrong(store);
    ASSERT_TRUE(wrong.begin_unsized("a mesh", id).ok());
    ASSERT_TRUE(wrong.append("abc").ok());
    ASSERT_TRUE(wrong.append("").ok());
    EXPECT_THAT(wrong.finish().status().message(), HasSubstr("hash"));
  }
  {
    MeshUpload cut(store);
    ASSERT_TRUE(cut.begin_unsized("a mesh", "").ok());
    ASSERT_TRUE(cut.append("abc").ok());
    EXPECT_THAT(cut.finish().status().message(), HasSubstr("after 3 bytes without the empty chunk"));
  }
  {
    MeshUpload broken(store);
    ASSERT_TRUE(broken.begin_unsized("a mesh", id).ok());
    ASSERT_TRUE(broken.append("abc").ok());
  }
  EXPECT_EQ(store.received(id), 0u) << "how long it would be nobody knows, so nothing is kept";
  EXPECT_EQ(store.usage().bytes, 0u);
}

/// What is sent before the connection breaks.
void upload_part(MeshStore& store, const std::string& bytes, const std::string& id, std::size_t begin, std::size_t end,
                 const Maker& maker = {}) {
  MeshUpload upload(store, maker);
  ASSERT_TRUE(upload.begin("a mesh", bytes.size(), id, begin).ok());
  ASSERT_TRUE(upload.append(std::string_view(bytes).substr(begin, end - begin)).ok());
}

std::string id_of(const std::string& bytes) {
  MeshStore other({1 << 26, 1 << 25});
  return (*upload(other, bytes))->id;
}

TEST(MeshStore, GoesOnWhereAnUploadBrokeOff) {
  MeshStore store({1 << 26, 1 << 25});
  const std::string bytes = pattern(5'000'000, 1), id = id_of(bytes);
  EXPECT_EQ(store.received(id), 0u);
  upload_part(store, bytes, id, 0, 2'000'000);
  EXPECT_EQ(store.received(id), 2'000'000u);
  upload_part(store, bytes, id, 2'000'000, 2'000'001);
  EXPECT_EQ(store.received(id), 2'000'001u);
  {
    MeshUpload elsewhere(store);
    EXPECT_TRUE(absl::IsFailedPrecondition(elsewhere.begin("", bytes.size(), id, 1000)));
    EXPECT_TRUE(absl::IsFailedPrecondition(elsewhere.begin("", bytes.size() + 1, id, 2'000'001)));
  }
  EXPECT_EQ(store.received(id), 2'000'001u) << "still there";
  MeshUpload last(store);
  ASSERT_TRUE(last.begin("", bytes.size(), id, 2'000'001).ok());
  EXPECT_EQ(store.received(id), 0u) << "one at a time";
  ASSERT_TRUE(last.append(std::string_view(bytes).substr(2'000'001)).ok());
  const auto mesh = last.finish();
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_EQ((*mesh)->id, id);
  EXPECT_EQ((*mesh)->name, "a mesh");
  EXPECT_EQ(store.usage().meshes, 1u);
}

TEST(MeshStore, WhatCannotBeContinuedIsForgotten) {
  MeshStore store({1 << 26, 1 << 25});
  const std::string bytes = pattern(3'000'000, 1), id = id_of(bytes);
  upload_part(store, bytes, "", 0, 1'000'000);  // nobody could name it
  EXPECT_EQ(store.usage().bytes, 0u);
  std::string wrong = bytes;
  wrong[0] ^= 1;
  upload_part(store, wrong, id, 0, 1'000'000);
  {
    MeshUpload last(store);
    ASSERT_TRUE(last.begin("", bytes.size(), id, 1'000'000).ok());
    ASSERT_TRUE(last.append(std::string_view(bytes).substr(1'000'000)).ok());
    EXPECT_TRUE(absl::IsInvalidArgument(last.finish().status()));
  }
  EXPECT_EQ(store.received(id), 0u) << "it would never hash to that";
  EXPECT_EQ(store.usage().bytes, 0u);
}

TEST(MeshStore, BrokenUploadsMakeRoom) {
  MeshStore store({3'300'000, 3'000'000});
  const std::string first = pattern(3'000'000, 1), second = pattern(3'000'000, 2);
  upload_part(store, first, id_of(first), 0, 2'900'000);
  EXPECT_TRUE(upload(store, second).ok());
  EXPECT_EQ(store.received(id_of(first)), 0u);
  // Many small ones take no more than a few places.
  MeshStore large({1 << 26, 1 << 25});
  for (int i = 0; i < 100; ++i) upload_part(large, pattern(1000, i), id_of(pattern(1000, i)), 0, 10);
  EXPECT_LE(large.usage().bytes, 4u * 5096u);
}

TEST(MeshStore, BeginningsAreTheirSendersOnly) {
  MeshStore store({1 << 26, 1 << 25});
  const std::string bytes = pattern(3'000'000, 1), id = id_of(bytes);
  const Maker anna{"anna", "anna"}, bert{"bert", "bert"};
  std::string wrong = bytes;
  wrong[0] ^= 1;
  upload_part(store, bytes, id, 0, 1'000'000, anna);
  upload_part(store, wrong, id, 0, 2'000'000, bert);
  EXPECT_EQ(store.received(id, anna), 1'000'000u);
  EXPECT_EQ(store.received(id, bert), 2'000'000u);
  // Who leaves many behind loses his own.
  for (int i = 0; i < 100; ++i) upload_part(store, pattern(1000, i), id_of(pattern(1000, i)), 0, 10, bert);
  EXPECT_EQ(store.received(id, bert), 0u);
  MeshUpload last(store, anna);
  ASSERT_TRUE(last.begin("", bytes.size(), id, 1'000'000).ok());
  ASSERT_TRUE(last.append(std::string_view(bytes).substr(1'000'000)).ok());
  EXPECT_TRUE(last.finish().ok());
}

class MeshFolder : public ::testing::Test {
 protected:
  curvecast::testing::TemporaryFolder folder_;
  MeshStore store_{{1 << 26, 1 << 25}, folder_.path()};
};

TEST_F(MeshFolder, KeepsFilesWithoutNames) {
  const std::string bytes = pattern(3'000'000, 1);
  const auto mesh = upload(store_, bytes);
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  const auto same = [&] { return std::ranges::equal((*mesh)->bytes(), bytes); };
  EXPECT_TRUE(same());
  EXPECT_THAT(folder_.names(), ::testing::IsEmpty()) << "nothing stays behind, whatever happens to the process";
  (*mesh)->release_pages();
  EXPECT_TRUE(same()) << "and read again";
  EXPECT_EQ((*mesh)->id, id_of(bytes)) << "as in memory";
  EXPECT_EQ(store_.usage().bytes, 3'000'000u + 4096) << "nothing is reserved ahead";
}

TEST_F(MeshFolder, GoesOnWhereAnUploadBrokeOff) {
  const std::string bytes = pattern(3'000'000, 2);
  const std::string id = id_of(bytes);
  upload_part(store_, bytes, id, 0, 1'000'000);
  EXPECT_EQ(store_.received(id), 1'000'000u);
  MeshUpload rest(store_);
  ASSERT_TRUE(rest.begin("a mesh", bytes.size(), id, 1'000'000).ok());
  ASSERT_TRUE(rest.append(std::string_view(bytes).substr(1'000'000)).ok());
  const auto mesh = rest.finish();
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_TRUE(std::ranges::equal((*mesh)->bytes(), bytes));
}

TEST_F(MeshFolder, TakesMemoryWhereItIsGone) {
  MeshStore nowhere({1 << 26, 1 << 25}, folder_ / "nowhere");
  const std::string bytes = pattern(3'000'000, 3);
  const auto mesh = upload(nowhere, bytes);
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_TRUE(std::ranges::equal((*mesh)->bytes(), bytes));
  (*mesh)->release_pages();
  EXPECT_TRUE(std::ranges::equal((*mesh)->bytes(), bytes)) << "of which there is nothing to let go";
}

}  // namespace
}  // namespace curvecast::server
