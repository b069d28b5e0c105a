#include "tests/server/store/store_contract.h"

#include <absl/strings/str_cat.h>
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "tests/server/store/fake_s3.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::server {
namespace {

using ::curvecast::testing::bytes_of;
using ::curvecast::testing::TemporaryFolder;
using ::curvecast::testing::write_file;

/// A store, and files of ours.
class Check {
 public:
  explicit Check(Store& store) : store_(store) {}

  void put(const std::string& name, const std::string& bytes) {
    write_file(folder_ / "from", bytes);
    EXPECT_EQ(store_.put(name, folder_ / "from", nullptr), absl::OkStatus()) << name;
    EXPECT_EQ(bytes_of(folder_ / "from"), bytes);
  }

  void expect(const std::string& name, const std::string& bytes) {
    EXPECT_EQ(store_.get(name, folder_ / "to", nullptr), absl::OkStatus()) << name;
    EXPECT_TRUE(bytes_of(folder_ / "to") == bytes) << name << ": other bytes than were put";
    const auto size = store_.size(name, nullptr);
    EXPECT_TRUE(size.ok()) << size.status();
    EXPECT_EQ(size.value_or(0), bytes.size()) << name;
  }

  void expect_none(const std::string& name) {
    write_file(folder_ / "to", "as it was");
    EXPECT_TRUE(absl::IsNotFound(store_.get(name, folder_ / "to", nullptr))) << name;
    EXPECT_EQ(bytes_of(folder_ / "to"), "as it was");
    EXPECT_TRUE(absl::IsNotFound(store_.size(name, nullptr).status())) << name;
    EXPECT_EQ(store_.remove(name, nullptr), absl::OkStatus()) << name;
  }

  void remove(const std::string& name) { EXPECT_EQ(store_.remove(name, nullptr), absl::OkStatus()) << name; }

  void expect_errors() {
    EXPECT_TRUE(absl::IsNotFound(store_.put("meshes/a", folder_ / "missing", nullptr)));
    EXPECT_TRUE(absl::IsNotFound(store_.put("meshes/a", folder_.path(), nullptr))) << "a folder is no file";
    for (const char* name : {"", "/a", "a/", "a//b", "../a", "a/./b", "a b", "a\nb", "\xc3\xa9"}) {
      EXPECT_FALSE(store_.put(name, folder_ / "from", nullptr).ok()) << name;
      EXPECT_TRUE(absl::IsNotFound(store_.get(name, folder_ / "to", nullptr))) << name;
    }
    const std::atomic<bool> cancel = true;
    EXPECT_TRUE(absl::IsCancelled(store_.get("meshes/a", folder_ / "to", &cancel)));
    EXPECT_TRUE(absl::IsCancelled(store_.put("meshes/a", folder_ / "from", &cancel)));
    expect_none("meshes/a");
  }

 private:
  Store& store_;
  TemporaryFolder folder_;
};

}  // namespace

void expect_store_contract(Store& store, const std::vector<std::size_t>& sizes) {
  Check check(store);
  check.expect_none("sessions/0123456789abcdef.v7.curve");
  std::uint64_t seed = 0;
  for (const std::size_t size : sizes) {
    const std::string name = absl::StrCat("sessions/", size, ".v7.curve");
    const std::string bytes = some_bytes(size, ++seed);
    check.put(name, bytes);
    check.expect(name, bytes);
    const std::string others = some_bytes(size + 1, ++seed);
    check.put(name, others);
    check.expect(name, others);
    check.put(name, "");
    check.expect(name, "");
    check.remove(name);
    check.expect_none(name);
  }
  check.put("meshes/a-b_c.D", "mesh");
  check.put("marker", "");
  check.expect("meshes/a-b_c.D", "mesh");
  check.expect("marker", "");
  check.remove("meshes/a-b_c.D");
  check.expect("marker", "");
  check.remove("marker");
  check.expect_errors();

  std::vector<std::thread> threads;
  for (int thread = 0; thread < 6; ++thread) {
    threads.emplace_back([&store, &sizes, thread] {
      Check own(store);
      for (std::size_t i = 0; i < sizes.size(); ++i) {
        const std::string name = absl::StrCat("meshes/", thread, "-", i);
        const std::string bytes = some_bytes(sizes[i], 1000 + 100 * thread + i);
        own.put(name, bytes);
        own.expect(name, bytes);
        own.remove(name);
        own.expect_none(name);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
}

}  // namespace curvecast::server
