#include "client/lib/surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "client/lib/client.h"
#include "tests/client/fake_connection.h"

namespace curvecast::client {
namespace {

using ::testing::_;
using ::testing::HasSubstr;
using ::testing::Return;

std::vector<v1::GetSurfaceResponse> responses() {
  std::vector<v1::GetSurfaceResponse> all(3);
  all[0].mutable_info()->set_bytes(12);
  all[0].mutable_info()->set_triangles(1);
  all[1].set_chunk(std::string("DRACO\2\2\1", 8));
  all[2].set_chunk("rest");
  return all;
}

TEST(Surface, JoinsChunks) {
  auto connection = std::make_shared<FakeConnection>();
  EXPECT_CALL(*connection, get_surface(_, _)).WillOnce(Return(responses()));
  const auto surface = Client(connection).get_surface({});
  ASSERT_TRUE(surface.ok()) << surface.status();
  EXPECT_EQ(surface->info.triangles(), 1u);
  EXPECT_EQ(surface->drc, std::string("DRACO\2\2\1rest", 12));
}

TEST(Surface, RefusesWhatIsNoneOrNotWhole) {
  const auto refusal = [](const std::vector<v1::GetSurfaceResponse>& all) {
    const auto surface = join_surface(all);
    EXPECT_EQ(surface.status().code(), absl::StatusCode::kDataLoss);
    return std::string(surface.status().message());
  };
  EXPECT_THAT(refusal({}), HasSubstr("without its beginning"));
  EXPECT_THAT(refusal({responses()[1]}), HasSubstr("without its beginning"));
  auto all = responses();
  all.pop_back();
  EXPECT_THAT(refusal(all), HasSubstr("8 bytes of a surface of 12"));
  all = responses();
  all.push_back(all[0]);
  EXPECT_THAT(refusal(all), HasSubstr("two beginnings"));
  all = responses();
  (*all[1].mutable_chunk())[7] = 0;  // a cloud of points
  EXPECT_THAT(refusal(all), HasSubstr("no mesh"));
}

}  // namespace
}  // namespace curvecast::client
