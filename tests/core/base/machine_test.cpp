#include "core/base/machine.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <thread>

#include "tests/support/temporary_folder.h"

namespace curvecast {
namespace {

constexpr auto kNoMemoryLimit = std::numeric_limits<std::uint64_t>::max();
constexpr double kNoCoreLimit = std::numeric_limits<double>::max();

/// A machine's files of control groups.
class Groups : public ::testing::Test {
 protected:
  void write(const std::string& path, const std::string& text) {
    const std::filesystem::path file = std::filesystem::path(root()) / path;
    std::filesystem::create_directories(file.parent_path());
    testing::write_file(file.string(), text);
  }
  std::string root() const { return folder_ / "root"; }

 private:
  const testing::TemporaryFolder folder_;
};

TEST_F(Groups, LimitNothingWhereThereAreNone) {
  EXPECT_EQ(read_group_limits(root()).memory_bytes, kNoMemoryLimit);
  EXPECT_EQ(read_group_limits(root()).cores, kNoCoreLimit);
}

TEST_F(Groups, OfTheSecondVersionLimitWithThoseAroundThem) {
  write("proc/self/cgroup", "0::/system/curvecast\n");
  write("sys/fs/cgroup/system/curvecast/memory.max", "max\n");
  write("sys/fs/cgroup/system/curvecast/cpu.max", "150000 100000\n");
  write("sys/fs/cgroup/system/memory.max", "536870912\n");
  write("sys/fs/cgroup/system/cpu.max", "max 100000\n");
  EXPECT_EQ(read_group_limits(root()).memory_bytes, 536870912u);
  EXPECT_EQ(read_group_limits(root()).cores, 1.5);
}

TEST_F(Groups, OfTheFirstVersionLimitToo) {
  write("proc/self/cgroup", "5:cpu,cpuacct:/docker/a\n3:memory:/docker/a\n2:cpuset:/x\n");
  write("sys/fs/cgroup/memory/docker/a/memory.limit_in_bytes", "1000000000\n");
  write("sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n");
  write("sys/fs/cgroup/cpu,cpuacct/docker/a/cpu.cfs_quota_us", "300000\n");
  write("sys/fs/cgroup/cpu,cpuacct/docker/a/cpu.cfs_period_us", "100000\n");
  write("sys/fs/cgroup/cpu,cpuacct/cpu.cfs_quota_us", "-1\n");
  write("sys/fs/cgroup/cpu,cpuacct/cpu.cfs_period_us", "100000\n");
  EXPECT_EQ(read_group_limits(root()).memory_bytes, 1000000000u);
  EXPECT_EQ(read_group_limits(root()).cores, 3);
}

TEST_F(Groups, LimitAContainerThatSeesOnlyItsOwn) {
  write("proc/self/cgroup", "5:cpu:/docker/a\n3:memory:/docker/a\n");
  write("sys/fs/cgroup/memory/memory.limit_in_bytes", "1000000000\n");
  write("sys/fs/cgroup/cpu/cpu.cfs_quota_us", "50000\n");
  write("sys/fs/cgroup/cpu/cpu.cfs_period_us", "100000\n");
  EXPECT_EQ(read_group_limits(root()).memory_bytes, 1000000000u);
  EXPECT_EQ(read_group_limits(root()).cores, 0.5);
}

TEST_F(Groups, WithBrokenFilesLimitNothing) {
  write("proc/self/cgroup", "nonsense\n0::\n1:memory:relative\n");
  write("sys/fs/cgroup/memory.max", "\n");
  write("sys/fs/cgroup/cpu.max", "-5 0\n");
  EXPECT_EQ(read_group_limits(root()).memory_bytes, kNoMemoryLimit);
  EXPECT_EQ(read_group_limits(root()).cores, kNoCoreLimit);
}

TEST(Machine, HasACoreAndMemory) {
  EXPECT_GE(machine_cores(), 1);
  EXPECT_LE(machine_cores(), static_cast<int>(std::max(1U, std::thread::hardware_concurrency())));
  EXPECT_GT(machine_memory_bytes(), std::uint64_t{16} << 20);
}

}  // namespace
}  // namespace curvecast
