#include "client/lib/curve.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <string>

#include "client/lib/client.h"
#include "tests/client/fake_connection.h"

namespace curvecast::client {
namespace {

constexpr std::uint32_t kHalf = 1u << 29;  // of the square's side

template <typename T>
std::string bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

void add_vertex(v1::CurveChunk& chunk, float x, std::uint32_t column, std::uint32_t row) {
  chunk.set_count(chunk.count() + 1);
  chunk.mutable_positions()->append(bytes_of<float>({x, 2, 3}));
  chunk.mutable_normals()->append(bytes_of<std::int16_t>({0, -32767, 0}));
  chunk.mutable_areas()->append(bytes_of<float>({0.5f}));
  chunk.mutable_cells()->append(bytes_of<std::uint32_t>({column * kHalf, row * kHalf}));
  chunk.mutable_levels()->push_back('\1');
}

/// Two discs of four vertices each; the first in two chunks.
std::vector<v1::GetCurveResponse> responses() {
  std::vector<v1::GetCurveResponse> all(4);
  all[0].mutable_info()->set_discs(2);
  all[0].mutable_info()->set_curve_vertices(8);
  all[0].mutable_info()->mutable_origin()->set_x(100);
  for (const std::size_t i : {std::size_t{1}, std::size_t{3}}) {
    v1::CurveChunk &first = *all[i].mutable_chunk(), &second = *all[i == 1 ? 2 : 3].mutable_chunk();
    first.set_disc(i / 2);
    second.set_disc(i / 2);
    add_vertex(first, 0, 0, 0);
    add_vertex(first, 1, 0, 1);
    add_vertex(second, 2, 1, 1);
    add_vertex(second, 3, 1, 0);
  }
  return all;
}

TEST(Curve, JoinsChunks) {
  const auto curve = decode_curve(responses());
  ASSERT_TRUE(curve.ok()) << curve.status();
  EXPECT_EQ(curve->info.origin().x(), 100);
  ASSERT_EQ(curve->discs.size(), 2u);
  for (const CurveDisc& disc : curve->discs) {
    ASSERT_EQ(disc.size(), 4u);
    EXPECT_EQ(disc.positions[3][0], 3);
    EXPECT_EQ(disc.normals[2][1], -32767);
    EXPECT_EQ(disc.areas[1], 0.5f);
    EXPECT_EQ(disc.side(0), 0.5);
    EXPECT_EQ(disc.centre(1), (std::array<double, 2>{0.25, 0.75}));
  }
}

TEST(Curve, ClientsAskForASession) {
  const auto connection = std::make_shared<::testing::NiceMock<FakeConnection>>();
  Client client(connection);
  EXPECT_CALL(*connection, get_curve)
      .WillOnce([](const v1::GetCurveRequest& request, std::stop_token) {
        EXPECT_EQ(request.session_id(), "s");
        return responses();
      })
      .WillOnce(::testing::Return(absl::NotFoundError("no session")));
  EXPECT_EQ(client.get_curve("s")->discs.size(), 2u);
  EXPECT_TRUE(absl::IsNotFound(client.get_curve("s").status()));
}

TEST(Curve, RefusesWhatMakesNoSense) {
  using Chunk = v1::CurveChunk;
  const auto put = [](std::string* bytes, const std::string& value) { bytes->replace(0, value.size(), value); };
  const std::vector<std::function<void(Chunk&)>> spoilers = {
      [](Chunk& c) { c.set_disc(2); },
      [](Chunk& c) { c.set_disc(0); },
      [](Chunk& c) { c.set_disc(~0u); },
      [](Chunk& c) { c.set_count(5); },
      [](Chunk& c) { c.set_count(~0u); },
      [](Chunk& c) { c.Clear(), c.set_disc(1); },
      [](Chunk& c) { c.mutable_positions()->pop_back(); },
      [](Chunk& c) { c.mutable_positions()->resize(36); },
      [](Chunk& c) { c.mutable_normals()->resize(18); },
      [](Chunk& c) { c.mutable_areas()->resize(12); },
      [](Chunk& c) { c.clear_cells(); },
      [](Chunk& c) { c.mutable_levels()->push_back('\1'); },
      [&](Chunk& c) { put(c.mutable_positions(), bytes_of<float>({std::nanf("")})); },
      [&](Chunk& c) { put(c.mutable_positions(), bytes_of<float>({std::numeric_limits<float>::infinity()})); },
      [&](Chunk& c) { put(c.mutable_normals(), bytes_of<std::int16_t>({-32768})); },
      [&](Chunk& c) { put(c.mutable_areas(), bytes_of<float>({-1})); },
      [&](Chunk& c) { put(c.mutable_areas(), bytes_of<float>({std::nanf("")})); },
      [&](Chunk& c) { put(c.mutable_cells(), bytes_of<std::uint32_t>({2 * kHalf})); },
      [&](Chunk& c) { put(c.mutable_cells(), bytes_of<std::uint32_t>({1})); },
      [](Chunk& c) { (*c.mutable_levels())[0] = '\x1f'; },
      [](Chunk& c) { (*c.mutable_levels())[0] = '\xff'; }};
  for (std::size_t i = 0; i < spoilers.size(); ++i) {
    auto spoilt = responses();
    spoilers[i](*spoilt[3].mutable_chunk());
    EXPECT_EQ(decode_curve(spoilt).status().code(), absl::StatusCode::kDataLoss) << i;
  }
  EXPECT_FALSE(decode_curve({}).ok());
  auto cut_short = responses();
  cut_short.pop_back();
  EXPECT_FALSE(decode_curve(cut_short).ok());
  auto without_info = responses();
  without_info[0].Clear();
  EXPECT_FALSE(decode_curve(without_info).ok());
  auto nowhere = responses();
  nowhere[0].mutable_info()->mutable_origin()->set_y(std::nan(""));
  EXPECT_FALSE(decode_curve(nowhere).ok());
}

}  // namespace
}  // namespace curvecast::client
