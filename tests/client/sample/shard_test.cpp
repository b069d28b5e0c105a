#include "client/cli/sample/shard.h"

#include <absl/strings/str_cat.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

namespace curvecast::cli {
namespace {

using ::testing::HasSubstr;

using Variables = std::map<std::string, std::string>;

absl::StatusOr<Shard> parse(const std::string& text, std::uint64_t count = 0, const Variables& variables = {}) {
  return parse_shard(text, count, [&](const std::string& name) {
    const auto found = variables.find(name);
    return found == variables.end() ? std::string() : found->second;
  });
}

void expect_shard(const absl::StatusOr<Shard>& shard, std::uint64_t index, std::uint64_t count) {
  ASSERT_TRUE(shard.ok()) << shard.status();
  EXPECT_EQ(shard->index, index);
  EXPECT_EQ(shard->count, count);
}

void expect_refused(const absl::StatusOr<Shard>& shard, const std::string& message) {
  EXPECT_TRUE(absl::IsInvalidArgument(shard.status()));
  EXPECT_THAT(std::string(shard.status().message()), HasSubstr(message));
}

Variables slurm(int id, int first, int last, int count) {
  return {{"SLURM_ARRAY_TASK_ID", std::to_string(id)},
          {"SLURM_ARRAY_TASK_MIN", std::to_string(first)},
          {"SLURM_ARRAY_TASK_MAX", std::to_string(last)},
          {"SLURM_ARRAY_TASK_COUNT", std::to_string(count)}};
}

TEST(Shard, EveryEntryIsInOneShard) {
  for (const std::uint64_t count : {1, 2, 3, 7}) {
    for (std::uint64_t entry = 0; entry < 20; ++entry) {
      int holders = 0;
      for (std::uint64_t index = 0; index < count; ++index) holders += parse(absl::StrCat(index, "/", count))->holds(entry);
      EXPECT_EQ(holders, 1) << entry << " of " << count;
    }
  }
}

TEST(Shard, ReadsIndexAndCount) {
  expect_shard(parse("0/1"), 0, 1);
  expect_shard(parse("3/4"), 3, 4);
  for (const char* text : {"", "3", "3/", "/4", "a/b", "3/4/5", "-1/4", "0/0"}) expect_refused(parse(text), "neither I/N");
  expect_refused(parse("4/4"), "the last 3");
  expect_refused(parse("0/4", 4), "--shards goes with --shard auto");
}

TEST(Shard, KubernetesSaysTheIndex) {
  expect_shard(parse("auto", 8, {{"JOB_COMPLETION_INDEX", "5"}}), 5, 8);
  expect_refused(parse("auto", 0, {{"JOB_COMPLETION_INDEX", "5"}}), "say it with --shards");
  expect_refused(parse("auto", 5, {{"JOB_COMPLETION_INDEX", "5"}}), "$JOB_COMPLETION_INDEX is 5");
  expect_refused(parse("auto", 8, {{"JOB_COMPLETION_INDEX", "five"}}), "'five', not a number");
}

TEST(Shard, SlurmSaysBoth) {
  expect_shard(parse("auto", 0, slurm(2, 0, 3, 4)), 2, 4);
  expect_shard(parse("auto", 64, slurm(17, 3, 17, 2)), 17, 64);
  expect_refused(parse("auto", 0, slurm(17, 3, 17, 2)), "2 from 3 to 17");
  expect_refused(parse("auto", 0, slurm(1, 1, 4, 4)), "not all from 0 on");
  expect_refused(parse("auto", 4, slurm(4, 1, 4, 4)), "the last 3");
  expect_refused(parse("auto", 0, {{"SLURM_ARRAY_TASK_ID", "1"}}), "$SLURM_ARRAY_TASK_MIN is '', not a number");
}

TEST(Shard, AutoWantsOneOfBoth) {
  expect_refused(parse("auto"), "neither is set");
  Variables both = slurm(0, 0, 1, 2);
  both.emplace("JOB_COMPLETION_INDEX", "0");
  expect_refused(parse("auto", 2, both), "both are set");
}

}  // namespace
}  // namespace curvecast::cli
