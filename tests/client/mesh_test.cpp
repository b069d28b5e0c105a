#include "client/lib/mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <string>

#include "client/lib/client.h"
#include "tests/client/fake_connection.h"

namespace curvecast::client {
namespace {

using ::testing::_;
using ::testing::HasSubstr;
using ::testing::Return;

template <typename T>
std::string bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

void add_vertices(v1::RemeshResponse& response, const std::vector<float>& positions) {
  v1::PointBlock& block = *response.mutable_chunk()->mutable_vertices();
  const std::size_t n = positions.size() / 3;
  block.set_count(static_cast<std::uint32_t>(n));
  block.mutable_origin()->set_x(100);
  block.mutable_raw()->set_positions(bytes_of(positions));
  block.mutable_raw()->set_normals(bytes_of(std::vector<float>(3 * n, std::sqrt(1.0f / 3))));
  block.mutable_raw()->set_radii(bytes_of(std::vector<float>(n, 1)));
}

/// A tetrahedron, its vertices and its triangles in two chunks each.
std::vector<v1::RemeshResponse> responses() {
  std::vector<v1::RemeshResponse> all(5);
  all[0].mutable_info()->set_vertices(4);
  all[0].mutable_info()->set_triangles(4);
  all[0].mutable_info()->set_components(1);
  add_vertices(all[1], {0, 0, 0, 1, 0, 0, 0, 1, 0});
  add_vertices(all[2], {0, 0, 1});
  all[3].mutable_chunk()->set_triangles(bytes_of<std::uint32_t>({0, 2, 1, 0, 1, 3, 1, 2, 3}));
  all[4].mutable_chunk()->set_triangles(bytes_of<std::uint32_t>({2, 0, 3}));
  return all;
}

TEST(Mesh, JoinsChunks) {
  const auto mesh = decode_mesh(responses());
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_EQ(mesh->info.components(), 1u);
  ASSERT_EQ(mesh->vertices.size(), 4u);
  EXPECT_EQ(mesh->vertices.origin[0], 100);
  EXPECT_EQ(mesh->vertices.positions[3][2], 1);
  ASSERT_EQ(mesh->triangles.size(), 4u);
  EXPECT_EQ(mesh->triangles[3], (std::array<std::uint32_t, 3>{2, 0, 3}));
}

TEST(Mesh, RefusesWhatMakesNoSense) {
  using Responses = std::vector<v1::RemeshResponse>;
  const std::vector<std::function<void(Responses&)>> spoilers = {
      [](auto& all) { all.clear(); },
      [](auto& all) { all.erase(all.begin()); },
      [](auto& all) { all.pop_back(); },
      [](auto& all) { all.erase(all.begin() + 2); },
      [](auto& all) { all[0].mutable_info()->set_vertices(5); },
      [](auto& all) { all[0].mutable_info()->set_triangles(1ull << 60); },
      [](auto& all) { all[1].mutable_chunk()->mutable_vertices()->set_count(7); },
      [](auto& all) { all[3].mutable_chunk()->mutable_triangles()->pop_back(); },
      [](auto& all) {
        all[4].mutable_chunk()->set_triangles(bytes_of<std::uint32_t>({2, 0, 4}));
      },
      [](auto& all) {
        all[4].mutable_chunk()->set_triangles(bytes_of<std::uint32_t>({2, 2, 3}));
      },
      [](auto& all) {
        all[1].mutable_chunk()->mutable_vertices()->mutable_raw()->set_positions(bytes_of(std::vector<float>(9, NAN)));
      },
  };
  for (std::size_t i = 0; i < spoilers.size(); ++i) {
    Responses all = responses();
    spoilers[i](all);
    EXPECT_EQ(decode_mesh(all).status().code(), absl::StatusCode::kDataLoss) << i;
  }
}

TEST(Mesh, ClientsAskForItAndCheckTheNumber) {
  const auto connection = std::make_shared<FakeConnection>();
  Client client(connection);
  v1::RemeshRequest request;
  request.mutable_sample()->set_points(4);
  EXPECT_CALL(*connection, remesh(_, _, _)).WillRepeatedly(Return(responses()));
  EXPECT_TRUE(client.remesh(request).ok());
  request.mutable_sample()->set_points(3);
  EXPECT_EQ(client.remesh(request).status().code(), absl::StatusCode::kDataLoss);
}

std::vector<v1::GetSurfaceResponse> surface_responses() {
  std::vector<v1::GetSurfaceResponse> all(3);
  all[0].mutable_info()->set_bytes(12);
  all[0].mutable_info()->set_triangles(1);
  all[1].set_chunk(std::string("DRACO\2\2\1", 8));
  all[2].set_chunk("rest");
  return all;
}

TEST(Surface, JoinsChunks) {
  auto connection = std::make_shared<FakeConnection>();
  EXPECT_CALL(*connection, get_surface(_, _)).WillOnce(Return(surface_responses()));
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
  EXPECT_THAT(refusal({surface_responses()[1]}), HasSubstr("without its beginning"));
  auto all = surface_responses();
  all.pop_back();
  EXPECT_THAT(refusal(all), HasSubstr("8 bytes of a surface of 12"));
  all = surface_responses();
  all.push_back(all[0]);
  EXPECT_THAT(refusal(all), HasSubstr("two beginnings"));
  all = surface_responses();
  (*all[1].mutable_chunk())[7] = 0;  // a cloud of points
  EXPECT_THAT(refusal(all), HasSubstr("no mesh"));
}

}  // namespace
}  // namespace curvecast::client
