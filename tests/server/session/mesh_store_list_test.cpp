// Whom a store tells of which files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "server/session/mesh_store.h"

namespace curvecast::server {
namespace {

/// Sends a file for somebody, and returns its id.
std::string upload_as(MeshStore& store, const std::string& who, const std::string& bytes) {
  MeshUpload upload(store, {who, who});
  EXPECT_TRUE(upload.begin("a mesh", bytes.size(), "").ok() && upload.append(bytes).ok());
  const auto mesh = upload.finish();
  EXPECT_TRUE(mesh.ok()) << mesh.status();
  return mesh.ok() ? (*mesh)->id : "";
}

/// The ids on a page for a caller who is known.
std::vector<std::string> listed(MeshStore& store, const std::string& who, const std::string& after = "", std::size_t most = 100) {
  std::vector<std::string> ids;
  for (const MeshStore::Listed& file : store.list({who, who}, false, after, most)) ids.push_back(file.id);
  return ids;
}

TEST(MeshStoreList, ListsFilesInPages) {
  MeshStore store({1 << 26, 1 << 25});
  std::vector<std::string> ids;
  for (int i = 0; i < 9; ++i)
    ids.push_back(upload_as(store, i % 2 == 0 ? "anna" : "bert", std::string(1000 + i, static_cast<char>('a' + i))));
  std::ranges::sort(ids);
  std::vector<std::string> all;
  for (std::vector<MeshStore::Listed> page; all.empty() || !page.empty();) {
    page = store.list({}, true, all.empty() ? "" : all.back(), 2);
    EXPECT_LE(page.size(), 2u);
    for (const MeshStore::Listed& file : page) {
      all.push_back(file.id);
      EXPECT_EQ(file.name, "a mesh");
      EXPECT_EQ(file.size, (*store.find(file.id))->size());
    }
  }
  EXPECT_EQ(all, ids);
  EXPECT_THAT(listed(store, "anna"), ::testing::SizeIs(5));
  EXPECT_THAT(listed(store, "anna", "", 3), ::testing::SizeIs(3));
  EXPECT_THAT(listed(store, "bert"), ::testing::SizeIs(4));
  EXPECT_THAT(listed(store, "carl"), ::testing::IsEmpty());
  EXPECT_THAT(listed(store, "anna", std::string(32, 'f')), ::testing::IsEmpty());
}

TEST(MeshStoreList, WhatSeveralHaveIsListedForEach) {
  using ::testing::ElementsAre;
  MeshStore store({1 << 26, 1 << 25});
  const std::string id = upload_as(store, "anna", "abc");
  EXPECT_THAT(listed(store, "bert"), ::testing::IsEmpty()) << "he has never heard of it";
  ASSERT_TRUE(store.find(id, "bert").ok());
  EXPECT_THAT(listed(store, "bert"), ::testing::IsEmpty()) << "to use it is not to have it";
  store.note_user(id, "bert");
  store.note_user(std::string(32, '0'), "bert");  // nothing of that key
  EXPECT_EQ(upload_as(store, "carl", "abc"), id);
  for (const char* who : {"anna", "bert", "carl"}) EXPECT_THAT(listed(store, who), ElementsAre(id)) << who;
  const std::string of_server = upload_as(store, kOperator, "of the server");
  EXPECT_THAT(listed(store, "dora"), ElementsAre(of_server));
  for (int i = 0; i < 1000; ++i) store.note_user(id, "caller " + std::to_string(i));
  EXPECT_THAT(listed(store, "caller 999"), ::testing::Contains(id));
  EXPECT_THAT(listed(store, "caller 1"), ElementsAre(of_server)) << "so many are not kept";
  EXPECT_THAT(listed(store, "anna"), ::testing::Contains(id)) << "the sender is";
}

TEST(MeshStoreList, WhatMadeRoomIsListedForNobody) {
  MeshStore store({2'200'000, 1 << 20});
  const std::string first = upload_as(store, "anna", std::string(1'000'000, '1'));
  store.note_user(first, "bert");
  for (const char fill : {'2', '3'}) upload_as(store, "anna", std::string(1'000'000, fill));
  EXPECT_THAT(listed(store, "anna"), ::testing::AllOf(::testing::SizeIs(2), ::testing::Not(::testing::Contains(first))));
  EXPECT_EQ(upload_as(store, "carl", std::string(1'000'000, '1')), first);
  EXPECT_THAT(listed(store, "bert"), ::testing::IsEmpty()) << "it came back as another's";
}

TEST(MeshStoreList, IsolatedOwnersAreToldOfTheirOwn) {
  MeshStore store({1 << 26, 1 << 25, true});
  const std::string id = upload_as(store, "anna", "abc");
  upload_as(store, kOperator, "of the server");
  store.note_user((*store.find(id, "anna"))->key, "bert");
  EXPECT_THAT(listed(store, "anna"), ::testing::ElementsAre(id));
  EXPECT_THAT(listed(store, "anna", id), ::testing::IsEmpty());
  EXPECT_THAT(listed(store, "bert"), ::testing::IsEmpty());
  EXPECT_THAT(store.list({}, true, "", 100), ::testing::IsEmpty()) << "nobody in particular is an owner, too";
}

}  // namespace
}  // namespace curvecast::server
