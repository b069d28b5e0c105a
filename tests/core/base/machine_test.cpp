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
  /// Limits a group of version 1, where memory and processors have trees of their own.
  void limit_first(const std::string& cpu, const std::string& group, const std::string& memory, const std::string& quota) {
    write("sys/fs/cgroup/memory" + group + "/memory.limit_in_bytes", memory + "\n");
    write("sys/fs/cgroup/" + cpu + group + "/cpu.cfs_quota_us", quota + "\n");
    write("sys/fs/cgroup/" + cpu + group + "/cpu.cfs_period_us", "100000\n");
  }
  /// Limits one of version 2.
  void limit_second(const std::string& group, const std::string& memory, const std::string& quota) {
    write("sys/fs/cgroup" + group + "/memory.max", memory + "\n");
    write("sys/fs/cgroup" + group + "/cpu.max", quota + " 100000\n");
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
  limit_second("/system/curvecast", "max", "150000");
  limit_second("/system", "536870912", "max");
  EXPECT_EQ(read_group_limits(root()).memory_bytes, 536870912u);
  EXPECT_EQ(read_group_limits(root()).cores, 1.5);
}

TEST_F(Groups, OfTheFirstVersionLimitToo) {
  write("proc/self/cgroup", "5:cpu,cpuacct:/docker/a\n3:memory:/docker/a\n2:cpuset:/x\n");
  limit_first("cpu,cpuacct", "/docker/a", "1000000000", "300000");
  limit_first("cpu,cpuacct", "", "9223372036854771712", "-1");
  EXPECT_EQ(read_group_limits(root()).memory_bytes, 1000000000u);
  EXPECT_EQ(read_group_limits(root()).cores, 3);
}

TEST_F(Groups, LimitAContainerThatSeesOnlyItsOwn) {
  write("proc/self/cgroup", "5:cpu:/docker/a\n3:memory:/docker/a\n");
  limit_first("cpu", "", "1000000000", "50000");
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
