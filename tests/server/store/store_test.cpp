#include "server/store/store.h"

#include <gmock/gmock.h>

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;

TEST(Store, NamesLeadNowhereElse) {
  for (const char* name : {"meshes/ba7816bf8f01cfea414140de5dae2223", "sessions/0a.v7.curve", "probe", "a/b/c", "A-b_c.d"}) {
    EXPECT_TRUE(is_store_name(name)) << name;
  }
  for (const std::string& name :
       {std::string(), std::string("/"), std::string("/etc/passwd"), std::string("a//b"), std::string("a/"), std::string("."),
        std::string(".."), std::string("a/../b"), std::string("a/.hidden"), std::string("a b"), std::string("a\\b"),
        std::string("a\0b", 3), std::string("ä"), std::string(300, 'a')}) {
    EXPECT_FALSE(is_store_name(name)) << name;
  }
}

TEST(Store, AUrlThatIsNoneIsTold) {
  EXPECT_TRUE(open_store("file:///tmp/x").ok());
  for (const char* url : {"", "/tmp/x", "file:", "file://", "file://host/x", "http://host/x", "FILE:///tmp"}) {
    const absl::Status status = open_store(url).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << url;
    EXPECT_THAT(status.message(), HasSubstr("file:///DIR"));
  }
}

}  // namespace
}  // namespace curvecast::server
