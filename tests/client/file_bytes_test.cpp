#include "client/lib/file_bytes.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

namespace curvecast::client {
namespace {

using ::testing::HasSubstr;

std::string temporary(const std::string& name) { return ::testing::TempDir() + "/curvecast_file_bytes_" + name; }

TEST(FileBytes, ReadsWhatWasWritten) {
  const std::string path = temporary("round_trip");
  const std::string bytes("a\0b\xff", 4);
  ASSERT_TRUE(write_bytes(path, bytes).ok());
  EXPECT_EQ(*read_bytes(path, 4), bytes);
  EXPECT_TRUE(absl::IsInvalidArgument(read_bytes(path, 3).status()));
  ASSERT_TRUE(write_bytes(path, "shorter").ok());
  EXPECT_EQ(*read_bytes(path, 100), "shorter");
}

TEST(FileBytes, WritesOverWhatAKilledProcessLeft) {
  const std::string path = temporary("left"), half_written = path + ".curvecast-tmp";
  std::ofstream(half_written) << "longer than what comes now";
  ASSERT_TRUE(write_bytes(path, "whole").ok());
  EXPECT_EQ(*read_bytes(path, 100), "whole");
  EXPECT_FALSE(std::filesystem::exists(half_written));
}

TEST(FileBytes, OneWritesAFileAtATime) {
  const std::string path = temporary("contended"), half_written = path + ".curvecast-tmp";
  const int other = ::open(half_written.c_str(), O_WRONLY | O_CREAT, 0600);
  ASSERT_GE(other, 0);
  ASSERT_EQ(::flock(other, LOCK_EX), 0);
  const absl::Status status = write_bytes(path, "bytes");
  EXPECT_TRUE(absl::IsUnavailable(status));
  EXPECT_THAT(std::string(status.message()), HasSubstr(path + ": another process is writing it"));
  EXPECT_TRUE(std::filesystem::exists(half_written)) << "it is the other one's";
  ASSERT_EQ(::close(other), 0);
  EXPECT_TRUE(write_bytes(path, "bytes").ok());
}

TEST(FileBytes, LeavesNothingWhereItFails) {
  const std::string path = temporary("folder_there");
  std::filesystem::create_directories(path);
  EXPECT_TRUE(absl::IsFailedPrecondition(write_bytes(path, "bytes")));
  EXPECT_FALSE(std::filesystem::exists(path + ".curvecast-tmp"));
}

TEST(FileBytes, ReadsAtAnOffset) {
  const std::string path = temporary("offset");
  ASSERT_TRUE(write_bytes(path, "0123456789").ok());
  const auto file = InputFile::open(path);
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->size(), 10U);
  std::array<char, 4> four{};
  ASSERT_TRUE(file->read_at(3, four).ok());
  EXPECT_EQ(std::string(four.data(), 4), "3456");
  EXPECT_TRUE(absl::IsFailedPrecondition(file->read_at(8, four)));
}

TEST(FileBytes, SaysWhatCannotBeRead) {
  const absl::Status missing = InputFile::open(temporary("missing")).status();
  EXPECT_TRUE(absl::IsNotFound(missing));
  EXPECT_THAT(std::string(missing.message()), HasSubstr("missing: cannot be opened: No such file"));
  EXPECT_THAT(std::string(InputFile::open(::testing::TempDir()).status().message()), HasSubstr("is a directory"));
  ASSERT_TRUE(write_bytes(temporary("empty"), "").ok());
  EXPECT_THAT(std::string(InputFile::open(temporary("empty")).status().message()), HasSubstr("empty"));
  const std::string pipe = temporary("pipe");
  std::remove(pipe.c_str());
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THAT(std::string(InputFile::open(pipe).status().message()), HasSubstr("pipe"));
}

TEST(FileBytes, FindsOutWhetherAFileCouldBeWritten) {
  const std::string path = temporary("writable");
  std::remove(path.c_str());
  EXPECT_TRUE(check_writable(path).ok());
  EXPECT_FALSE(std::filesystem::exists(path));
  EXPECT_THAT(std::string(check_writable("/nonexistent/folder/x.ply").message()), HasSubstr("no folder /nonexistent/folder"));
  EXPECT_TRUE(absl::IsFailedPrecondition(check_writable(::testing::TempDir())));
  EXPECT_TRUE(absl::IsFailedPrecondition(write_bytes("/nonexistent/folder/x.ply", "bytes")));
}

}  // namespace
}  // namespace curvecast::client
