#include "core/base/mapped_file.h"

#include <absl/strings/str_cat.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <numeric>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/file_system.h"
#include "tests/support/temporary_folder.h"

namespace curvecast {
namespace {

using testing::TemporaryFolder;
using testing::write_file;

const std::size_t kPage = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));

class MappedFileTest : public ::testing::Test {
 protected:
  /// So many pages of 'x' and a bit.
  std::string make(const std::string& name, std::size_t pages) {
    const std::string path = folder_ / name;
    write_file(path, std::string(pages * kPage + 100, 'x'));
    return path;
  }
  static MappedFile map(const std::string& path) {
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    EXPECT_GE(descriptor, 0) << path;
    auto file = MappedFile::map(descriptor, static_cast<std::size_t>(::lseek(descriptor, 0, SEEK_END)));
    ::close(descriptor);
    EXPECT_TRUE(file.ok()) << file.status();
    return *std::move(file);
  }
  static std::size_t count(const MappedFile& file, char wanted) {
    return static_cast<std::size_t>(std::ranges::count(file.bytes(), static_cast<std::byte>(wanted)));
  }

  TemporaryFolder folder_;
};

TEST_F(MappedFileTest, HasTheFilesBytes) {
  const MappedFile file = map(make("a", 3));
  EXPECT_EQ(count(file, 'x'), 3 * kPage + 100);
  file.release_pages();
  EXPECT_EQ(count(file, 'x'), 3 * kPage + 100) << "read again";
  EXPECT_FALSE(file.is_lost());
  EXPECT_FALSE(MappedFile().is_lost());
  EXPECT_TRUE(MappedFile().bytes().empty());
}

TEST_F(MappedFileTest, BytesOfAFileThatGotShorterAreZeros) {
  const std::string path = make("a", 5);
  const MappedFile file = map(path), other = map(make("b", 5));
  EXPECT_EQ(count(file, 'x'), 5 * kPage + 100) << "they were there";
  ASSERT_EQ(::truncate(path.c_str(), static_cast<off_t>(2 * kPage)), 0);
  EXPECT_FALSE(file.is_lost()) << "nobody has looked";
  EXPECT_EQ(count(file, 'x'), 2 * kPage);
  EXPECT_EQ(count(file, 0), 3 * kPage + 100);
  EXPECT_TRUE(file.is_lost());
  EXPECT_EQ(count(other, 'x'), 5 * kPage + 100);
  EXPECT_FALSE(other.is_lost());
}

TEST_F(MappedFileTest, WhatIsMappedLaterIsWhole) {
  const std::string path = make("a", 4);
  {
    const MappedFile file = map(path);
    ASSERT_EQ(::truncate(path.c_str(), 0), 0);
    EXPECT_EQ(count(file, 'x'), 0u);
    EXPECT_TRUE(file.is_lost());
  }
  const MappedFile again = map(make("a", 4));
  EXPECT_FALSE(again.is_lost());
  EXPECT_EQ(count(again, 'x'), 4 * kPage + 100);
}

TEST_F(MappedFileTest, FilesMove) {
  const std::string path = make("a", 4);
  MappedFile file = map(path);
  MappedFile moved = std::move(file);
  ASSERT_EQ(::truncate(path.c_str(), 0), 0);
  EXPECT_EQ(count(moved, 'x'), 0u);
  EXPECT_TRUE(moved.is_lost());
  moved = map(make("b", 1));
  EXPECT_FALSE(moved.is_lost());
}

TEST_F(MappedFileTest, ManyFilesAndThreads) {
  // More than the handler's first table holds; every second is shortened while all are read and others come and go.
  constexpr std::size_t kFiles = 700;
  std::vector<MappedFile> files;
  std::vector<std::string> paths;
  for (std::size_t i = 0; i < kFiles; ++i) {
    paths.push_back(make(absl::StrCat("f", i), 2));
    files.push_back(map(paths.back()));
  }
  const std::string short_lived = make("short", 2);
  std::atomic<bool> over = false;
  std::thread comes_and_goes([&] {
    while (!over) EXPECT_EQ(count(map(short_lived), 'x'), 2 * kPage + 100);
  });
  std::vector<std::thread> readers;
  for (int t = 0; t < 3; ++t) {
    readers.emplace_back([&] {
      for (int round = 0; round < 20; ++round) {
        for (const MappedFile& file : files) EXPECT_GE(count(file, 'x'), kPage);
      }
    });
  }
  for (std::size_t i = 0; i < kFiles; i += 2) ASSERT_EQ(::truncate(paths[i].c_str(), static_cast<off_t>(kPage)), 0);
  for (std::thread& reader : readers) reader.join();
  over = true;
  comes_and_goes.join();
  for (std::size_t i = 0; i < kFiles; ++i) {
    EXPECT_EQ(count(files[i], 'x'), i % 2 == 0 ? kPage : 2 * kPage + 100);
    EXPECT_EQ(files[i].is_lost(), i % 2 == 0) << i;
  }
}

using MappedFileDeathTest = MappedFileTest;

TEST_F(MappedFileDeathTest, OtherMappingsAreAsWithoutUs) {
  const std::string path = make("a", 2);
  const MappedFile ours = map(make("b", 2));
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const volatile char* const theirs = static_cast<const char*>(::mmap(nullptr, 2 * kPage, PROT_READ, MAP_SHARED, descriptor, 0));
  ASSERT_NE(theirs, MAP_FAILED);
  ::close(descriptor);
  ASSERT_EQ(::truncate(path.c_str(), 0), 0);
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  EXPECT_DEATH({ static_cast<void>(theirs[kPage]); }, "BUS");
  EXPECT_DEATH(::kill(::getpid(), SIGBUS), "");
#else
  EXPECT_EXIT({ static_cast<void>(theirs[kPage]); }, ::testing::KilledBySignal(SIGBUS), "");
  EXPECT_EXIT(::kill(::getpid(), SIGBUS), ::testing::KilledBySignal(SIGBUS), "");
#endif
}

TEST(FileSystem, KnowsRemoteOnes) {
  EXPECT_FALSE(is_local_type(0x6969)) << "NFS";
  EXPECT_FALSE(is_local_type(0x65735546)) << "FUSE";
  EXPECT_FALSE(is_local_type(0xff534d42)) << "CIFS";
  EXPECT_TRUE(is_local_type(0xef53)) << "ext4";
  EXPECT_TRUE(is_local_type(0x01021994)) << "tmpfs";
  EXPECT_TRUE(is_local_type(0x794c7630)) << "overlayfs";
  const int descriptor = ::open("/proc/self/exe", O_RDONLY | O_CLOEXEC);
  (void)is_on_local_disk(descriptor);
  ::close(descriptor);
  EXPECT_TRUE(is_on_local_disk(-1)) << "nobody knows";
}

}  // namespace
}  // namespace curvecast
