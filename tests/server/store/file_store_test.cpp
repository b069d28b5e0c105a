#include "server/store/file_store.h"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <thread>

#include "core/storage/atomic_file.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::server {
namespace {

namespace fs = std::filesystem;
using testing::bytes_of;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::TemporaryFolder;
using testing::write_file;
using Code = absl::StatusCode;

class FileStoreTest : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directory(root_); }
  std::string local(const std::string& name, const std::string& bytes) const {
    write_file(folder_ / name, bytes);
    return folder_ / name;
  }
  static std::vector<std::string> names(const std::string& folder) {
    std::vector<std::string> out;
    for (const auto& entry : fs::directory_iterator(folder)) out.push_back(entry.path().filename().string());
    std::ranges::sort(out);
    return out;
  }

  const TemporaryFolder folder_;
  const std::string root_ = folder_ / "store";
  const std::unique_ptr<Store> store_ = make_file_store(root_).value();
};

TEST_F(FileStoreTest, WhatIsPutIsGot) {
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{1} << 20, (std::size_t{3} << 20) + 17}) {
    std::string bytes(size, '\0');
    for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<char>(i * 7919 >> 3);
    ASSERT_TRUE(store_->put("sessions/a.v1.curve", local("a", bytes), nullptr).ok());
    EXPECT_EQ(store_->size("sessions/a.v1.curve", nullptr).value_or(99), size);
    ASSERT_TRUE(store_->get("sessions/a.v1.curve", folder_ / "b", nullptr).ok());
    EXPECT_EQ(bytes_of(folder_ / "b"), bytes);
  }
  EXPECT_THAT(names(root_), ElementsAre("sessions", "tmp"));
  EXPECT_THAT(names(root_ + "/tmp"), IsEmpty());
  EXPECT_THAT(names(root_ + "/sessions"), ElementsAre("a.v1.curve"));
}

TEST_F(FileStoreTest, WhatIsNotThereIsNotFound) {
  EXPECT_EQ(store_->get("meshes/x", folder_ / "b", nullptr).code(), Code::kNotFound);
  EXPECT_EQ(store_->size("meshes/x", nullptr).status().code(), Code::kNotFound);
  EXPECT_TRUE(store_->remove("meshes/x", nullptr).ok());
  EXPECT_EQ(store_->put("meshes/x", folder_ / "none", nullptr).code(), Code::kNotFound);
  EXPECT_FALSE(fs::exists(folder_ / "b"));
  ASSERT_TRUE(store_->put("meshes/x", local("a", "abc"), nullptr).ok());
  EXPECT_TRUE(store_->remove("meshes/x", nullptr).ok());
  EXPECT_EQ(store_->size("meshes/x", nullptr).status().code(), Code::kNotFound);
}

TEST_F(FileStoreTest, NamesLeadNowhereElse) {
  write_file(folder_ / "secret", "abc");
  for (const char* name : {"../secret", "/etc/passwd", "a/../../secret", ""}) {
    EXPECT_EQ(store_->get(name, folder_ / "b", nullptr).code(), Code::kNotFound);
    EXPECT_FALSE(store_->put(name, local("a", "x"), nullptr).ok());
    EXPECT_FALSE(store_->remove(name, nullptr).ok());
  }
  EXPECT_EQ(bytes_of(folder_ / "secret"), "abc");
}

TEST_F(FileStoreTest, WhatIsNoFileIsNotFound) {
  fs::create_directories(root_ + "/meshes/folder");
  ASSERT_EQ(::mkfifo((root_ + "/meshes/pipe").c_str(), 0600), 0);
  for (const char* name : {"meshes/folder", "meshes/pipe"}) {
    EXPECT_EQ(store_->size(name, nullptr).status().code(), Code::kNotFound);
    EXPECT_EQ(store_->get(name, folder_ / "b", nullptr).code(), Code::kNotFound) << "and nobody waits for it";
  }
}

TEST_F(FileStoreTest, IsAwayWhileItsFolderIs) {
  ASSERT_TRUE(store_->put("meshes/x", local("a", "abc"), nullptr).ok());
  fs::rename(root_, folder_ / "elsewhere");
  for (const absl::Status& status : {store_->get("meshes/x", folder_ / "b", nullptr), store_->size("meshes/x", nullptr).status(),
                                     store_->remove("meshes/x", nullptr), store_->put("meshes/y", folder_ / "a", nullptr),
                                     store_->put("y", folder_ / "a", nullptr)}) {
    EXPECT_EQ(status.code(), Code::kUnavailable) << status;
    EXPECT_THAT(status.message(), HasSubstr("mounted"));
  }
  EXPECT_FALSE(fs::exists(root_)) << "a store on a disk that is not mounted fills the one below";
  fs::rename(folder_ / "elsewhere", root_);
  ASSERT_TRUE(store_->get("meshes/x", folder_ / "b", nullptr).ok());
  EXPECT_EQ(bytes_of(folder_ / "b"), "abc");
}

TEST_F(FileStoreTest, NoPermissionIsTold) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may do everything";
  fs::permissions(root_, fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_EQ(store_->put("meshes/x", local("a", "abc"), nullptr).code(), Code::kPermissionDenied);
  fs::permissions(root_, fs::perms::owner_all);
  EXPECT_TRUE(store_->put("meshes/x", local("a", "abc"), nullptr).ok());
}

TEST_F(FileStoreTest, RemovesWhatKilledServersLeftHalfWritten) {
  fs::create_directories(root_ + "/tmp");
  write_file(root_ + "/tmp/file.abcdef.curvecast-tmp", "half");
  absl::StatusOr<AtomicFile> under_way = AtomicFile::create(root_ + "/tmp/other");
  ASSERT_TRUE(under_way.ok());
  ASSERT_TRUE(store_->put("meshes/x", local("a", "abc"), nullptr).ok());
  EXPECT_EQ(names(root_ + "/tmp").size(), 1u) << "what another one writes stays";
  EXPECT_FALSE(fs::exists(root_ + "/tmp/file.abcdef.curvecast-tmp"));
}

TEST_F(FileStoreTest, ReadersSeeWholeFilesWhileOthersReplaceThem) {
  const std::string first = local("1", std::string(std::size_t{2} << 20, 'a')), second = local("2", std::string(300'000, 'b'));
  ASSERT_TRUE(store_->put("meshes/x", first, nullptr).ok());
  std::atomic<bool> done = false;
  std::thread writer([&] {
    const std::unique_ptr<Store> other = make_file_store(root_).value();
    for (int i = 0; i < 20; ++i) EXPECT_TRUE(other->put("meshes/x", i % 2 == 0 ? second : first, nullptr).ok());
    done = true;
  });
  while (!done) {
    ASSERT_TRUE(store_->get("meshes/x", folder_ / "got", nullptr).ok());
    const std::string got = bytes_of(folder_ / "got");
    EXPECT_TRUE(got == bytes_of(first) || got == bytes_of(second)) << got.size();
  }
  writer.join();
}

TEST_F(FileStoreTest, CancelledCallsLeaveNothing) {
  std::atomic<bool> cancel = true;
  EXPECT_EQ(store_->put("meshes/x", local("a", std::string(std::size_t{64} << 20, 'a')), &cancel).code(), Code::kCancelled);
}

TEST(FileStore, WantsAnAbsolutePath) {
  EXPECT_EQ(make_file_store("").status().code(), Code::kInvalidArgument);
  EXPECT_EQ(make_file_store("a/b").status().code(), Code::kInvalidArgument);
}

}  // namespace
}  // namespace curvecast::server
