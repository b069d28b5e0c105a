#include "server/session/making_marks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>

#include "tests/support/temporary_folder.h"

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;

constexpr char kId[] = "0123456789abcdef0123456789abcdef";
constexpr std::chrono::seconds kPause{60};

class MakingMarksTest : public ::testing::Test {
 protected:
  /// A process that ends while it makes the session; false where it was not to make it.
  bool die(bool is_meant = false) {
    const pid_t child = ::fork();
    if (child == 0) {
      MakingMarks marks(folder_.path(), kPause);
      marks.enforce();
      if (!marks.begin(kId).ok()) ::_exit(1);
      if (is_meant) marks.forgive();
      ::_exit(0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return status == 0;
  }
  bool is_there() const { return std::filesystem::exists(mark_); }
  /// Lets time go by for the mark.
  void age(std::chrono::seconds time) { std::filesystem::last_write_time(mark_, std::filesystem::last_write_time(mark_) - time); }
  absl::Status begin() {
    MakingMarks marks(folder_.path(), kPause);
    marks.enforce();
    absl::Status status = marks.begin(kId);
    marks.end(kId);
    return status;
  }

  const testing::TemporaryFolder folder_;
  const std::string mark_ = folder_ / (std::string(kId) + ".making");
};

TEST_F(MakingMarksTest, LeaveNothingBehindThatEndedWell) {
  MakingMarks marks(folder_.path(), kPause);
  marks.enforce();
  ASSERT_TRUE(marks.begin(kId).ok());
  EXPECT_TRUE(is_there());
  marks.touch();
  marks.end(kId);
  EXPECT_FALSE(is_there());
  EXPECT_TRUE(marks.begin(kId).ok());
  marks.end(kId);
}

TEST_F(MakingMarksTest, RefuseForAWhileWhatEndedTheProcess) {
  ASSERT_TRUE(die());
  const absl::Status refused = begin();
  EXPECT_EQ(refused.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(refused.message()), HasSubstr("the server ended while it was made; it is not made again before 20"));
  EXPECT_TRUE(is_there());
  age(kPause);
  EXPECT_TRUE(begin().ok());
  EXPECT_FALSE(is_there()) << "it was made after all";
  EXPECT_TRUE(begin().ok());
}

TEST_F(MakingMarksTest, RefuseLongerEachTime) {
  ASSERT_TRUE(die());
  EXPECT_FALSE(die());
  age(kPause);
  ASSERT_TRUE(die()) << "a second time";
  age(kPause);
  EXPECT_FALSE(die());
  age(3 * kPause);
  ASSERT_TRUE(die()) << "a third time";
  age(15 * kPause);
  EXPECT_FALSE(begin().ok());
  age(kPause);
  EXPECT_TRUE(begin().ok());
}

TEST_F(MakingMarksTest, DoNotBlameASessionForAnEndThatWasMeant) {
  ASSERT_TRUE(die(true));
  EXPECT_FALSE(is_there());
  EXPECT_TRUE(begin().ok());
}

TEST_F(MakingMarksTest, LetAServerMakeWhatItIsStartedFor) {
  ASSERT_TRUE(die());
  MakingMarks marks(folder_.path(), kPause);
  EXPECT_TRUE(marks.begin(kId).ok());
  marks.end(kId);
}

TEST_F(MakingMarksTest, LetSeveralServersMakeTheSame) {
  MakingMarks one(folder_.path(), kPause), other(folder_.path(), kPause);
  one.enforce(), other.enforce();
  EXPECT_TRUE(one.begin(kId).ok());
  EXPECT_TRUE(other.begin(kId).ok());
  other.end(kId);
  EXPECT_TRUE(is_there()) << "it is the other one's";
  one.end(kId);
  EXPECT_FALSE(is_there());
}

TEST_F(MakingMarksTest, GoWhenNobodyWaitsForThemAnyMore) {
  ASSERT_TRUE(die());
  age(MakingMarks::kMostPause / 2);
  { const MakingMarks marks(folder_.path(), kPause); }
  EXPECT_TRUE(is_there());
  age(MakingMarks::kMostPause);
  { const MakingMarks marks(folder_.path(), kPause); }
  EXPECT_FALSE(is_there());
}

TEST_F(MakingMarksTest, AreNotNeededToMakeASession) {
  ::chmod(folder_.path().c_str(), 0500);
  EXPECT_TRUE(begin().ok());
  ::chmod(folder_.path().c_str(), 0700);
  testing::write_file(mark_, "garbage");
  EXPECT_FALSE(begin().ok()) << "somebody began";
}

}  // namespace
}  // namespace curvecast::server
