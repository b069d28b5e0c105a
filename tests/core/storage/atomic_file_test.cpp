#include "core/storage/atomic_file.h"

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <optional>

#include "tests/support/temporary_folder.h"

namespace curvecast {
namespace {

using testing::bytes_of;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::TemporaryFolder;
using testing::write_file;

std::span<const std::byte> as_bytes(const std::string& text) { return std::as_bytes(std::span(text)); }

TEST(AtomicFile, AppearsAtTheEnd) {
  const TemporaryFolder folder;
  const std::string path = folder / "file";
  write_file(path, "before");
  absl::StatusOr<AtomicFile> file = AtomicFile::create(path);
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_TRUE(file->resize(10).ok());
  EXPECT_TRUE(file->write_at(7, as_bytes("abc")).ok());
  EXPECT_TRUE(file->write_at(1, as_bytes("xyz")).ok());
  EXPECT_EQ(bytes_of(path), "before");
  EXPECT_TRUE(file->commit().ok());
  EXPECT_EQ(bytes_of(path), std::string("\0xyz\0\0\0abc", 10));
  EXPECT_THAT(folder.names(), ElementsAre("file"));
  struct stat status = {};
  ASSERT_EQ(::stat(path.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0600u);
}

TEST(AtomicFile, MayGetItsNameAtTheEnd) {
  const TemporaryFolder folder;
  const std::string path = folder / "file";
  write_file(path, "before");
  {
    absl::StatusOr<AtomicFile> given_up = AtomicFile::create_in(folder.path());
    ASSERT_TRUE(given_up.ok()) << given_up.status();
    EXPECT_TRUE(given_up->write_at(0, as_bytes("never")).ok());
  }
  EXPECT_THAT(folder.names(), ElementsAre("file"));
  absl::StatusOr<AtomicFile> file = AtomicFile::create_in(folder.path());
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_TRUE(file->write_at(0, as_bytes("after")).ok());
  EXPECT_EQ(bytes_of(path), "before");
  EXPECT_EQ(remove_stale_temporaries(folder.path()), 0u) << "its writer lives";
  char read[5] = {};
  EXPECT_EQ(::pread(file->descriptor(), read, sizeof read, 0), 5);
  EXPECT_TRUE(file->commit_as(path).ok());
  EXPECT_EQ(bytes_of(path), "after");
  EXPECT_THAT(folder.names(), ElementsAre("file"));
  std::filesystem::create_directory(folder / "folder");
  absl::StatusOr<AtomicFile> other = AtomicFile::create_in(folder.path());
  ASSERT_TRUE(other.ok());
  EXPECT_FALSE(other->commit_as(folder / "folder").ok()) << "a folder has that name";
  EXPECT_EQ(AtomicFile::create_in(folder / "nowhere").status().code(), absl::StatusCode::kNotFound);
}

TEST(AtomicFile, MayBeReadBeforeItHasItsName) {
  const TemporaryFolder folder;
  const std::string path = folder / "file";
  {
    absl::StatusOr<AtomicFile> file = AtomicFile::create_in(folder.path());
    ASSERT_TRUE(file.ok()) << file.status();
    EXPECT_TRUE(file->write_at(0, as_bytes("whole")).ok());
    const absl::StatusOr<std::string> temporary = file->sync();
    ASSERT_TRUE(temporary.ok()) << temporary.status();
    EXPECT_TRUE(is_temporary(*temporary));
    EXPECT_EQ(bytes_of(*temporary), "whole");
    EXPECT_FALSE(std::filesystem::exists(path));
    EXPECT_TRUE(file->commit_as(path).ok());
    EXPECT_EQ(bytes_of(path), "whole");
    absl::StatusOr<AtomicFile> given_up = AtomicFile::create_in(folder.path());
    ASSERT_TRUE(given_up.ok() && given_up->sync().ok());
    EXPECT_EQ(folder.names().size(), 2u);
  }
  EXPECT_THAT(folder.names(), ElementsAre("file"));
}

TEST(AtomicFile, IsPublishedWithoutWaitingForTheDisk) {
  const TemporaryFolder folder;
  absl::StatusOr<AtomicFile> file = AtomicFile::create(folder / "file");
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_TRUE(file->write_at(0, as_bytes("whole")).ok());
  EXPECT_TRUE(file->publish().ok());
  EXPECT_EQ(bytes_of(folder / "file"), "whole");
  EXPECT_THAT(folder.names(), ElementsAre("file"));
}

TEST(AtomicFile, LeavesNothingWhenGivenUp) {
  const TemporaryFolder folder;
  {
    absl::StatusOr<AtomicFile> file = AtomicFile::create(folder / "file");
    ASSERT_TRUE(file.ok());
    AtomicFile moved = *std::move(file);
    EXPECT_EQ(folder.names().size(), 1u);
    EXPECT_TRUE(is_temporary(folder.names()[0]));
  }
  EXPECT_THAT(folder.names(), IsEmpty());
}

TEST(AtomicFile, LeavesNothingWhenTheDiskIsFull) {
  // A limit on the size of files stands for the full disk.
  const TemporaryFolder folder;
  rlimit before = {};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto old_handler = ::signal(SIGXFSZ, SIG_IGN);
  const rlimit limit = {1000, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &limit), 0);
  {
    absl::StatusOr<AtomicFile> file = AtomicFile::create(folder / "file");
    ASSERT_TRUE(file.ok());
    const absl::Status written = file->write_at(0, as_bytes(std::string(5000, 'x')));  // a short write, then none
    EXPECT_FALSE(written.ok());
    EXPECT_THAT(std::string(written.message()), HasSubstr("file"));
    EXPECT_FALSE(file->resize(5000).ok());
  }
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  ::signal(SIGXFSZ, old_handler);
  EXPECT_THAT(folder.names(), IsEmpty());
}

TEST(AtomicFile, SaysWhereItCannotWrite) {
  const TemporaryFolder folder;
  write_file(folder / "file", "");
  EXPECT_EQ(AtomicFile::create(folder / "nowhere/file").status().code(), absl::StatusCode::kNotFound);
  const auto beneath_file = AtomicFile::create(folder / "file/file");
  ASSERT_FALSE(beneath_file.ok());
  EXPECT_THAT(std::string(beneath_file.status().message()), HasSubstr(folder / "file/file"));
  std::filesystem::create_directory(folder / "folder");
  absl::StatusOr<AtomicFile> file = AtomicFile::create(folder / "folder");
  ASSERT_TRUE(file.ok());
  EXPECT_FALSE(file->commit().ok()) << "a folder has that name";
}

TEST(AtomicFile, OnlyTemporariesOfTheDeadAreStale) {
  const TemporaryFolder folder;
  absl::StatusOr<AtomicFile> living = AtomicFile::create(folder / "living");
  ASSERT_TRUE(living.ok());
  const pid_t child = ::fork();
  if (child == 0) {
    // Leaves its file behind, as a killed process does.
    const std::optional<absl::StatusOr<AtomicFile>> file(AtomicFile::create(folder / "dead"));
    _exit(file->ok() ? 0 : 1);
  }
  int status = -1;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_EQ(status, 0);
  write_file(folder / "other", "somebody's");
  std::filesystem::create_directory(folder / "folder.curvecast-tmp");
  ASSERT_EQ(::mkfifo((folder / "pipe.curvecast-tmp").c_str(), 0600), 0);
  ASSERT_EQ(folder.names().size(), 5u);
  EXPECT_EQ(remove_stale_temporaries(folder.path()), 1u);
  EXPECT_EQ(folder.names().size(), 4u);
  EXPECT_TRUE(living->commit().ok());
  EXPECT_EQ(remove_stale_temporaries(folder.path()), 0u);
  EXPECT_EQ(remove_stale_temporaries(folder / "nowhere"), 0u);
}

}  // namespace
}  // namespace curvecast
