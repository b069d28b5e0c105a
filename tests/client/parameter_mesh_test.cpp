#include "client/lib/parameter_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

namespace curvecast::client {
namespace {

template <typename T>
std::string bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

/// Two discs, one triangle each; the first in two chunks.
std::vector<v1::GetParameterMeshResponse> responses() {
  std::vector<v1::GetParameterMeshResponse> all(4);
  all[0].mutable_info()->set_discs(2);
  all[0].mutable_info()->mutable_mesh()->set_faces(2);
  const std::vector<double> positions = {0, 0, 0, 1, 0, 0, 0, 1, 0}, uv = {0, 0, 1, 0, 0, 1};
  for (const std::size_t i : {std::size_t{1}, std::size_t{3}}) {
    v1::ParameterDiscChunk& chunk = *all[i].mutable_chunk();
    chunk.set_disc(i / 2);
    chunk.set_positions(bytes_of(positions));
    chunk.set_uv(bytes_of(uv));
    chunk.set_triangles(bytes_of<std::uint32_t>({0, 1, 2}));
    chunk.set_faces(bytes_of<std::uint32_t>({static_cast<std::uint32_t>(i / 2)}));
    chunk.set_area_ratios(bytes_of<double>({1}));
    chunk.set_border(bytes_of<std::uint32_t>({0, 1, 2}));
    chunk.set_border_cuts(std::string("\1\0\1", 3));
  }
  // The first disc's border comes later.
  v1::ParameterDiscChunk& rest = *all[2].mutable_chunk();
  rest.set_disc(0);
  rest.set_border(all[1].chunk().border().substr(4));
  rest.set_border_cuts(all[1].chunk().border_cuts().substr(1));
  all[1].mutable_chunk()->mutable_border()->resize(4);
  all[1].mutable_chunk()->mutable_border_cuts()->resize(1);
  return all;
}

TEST(ParameterMesh, JoinsChunks) {
  const auto mesh = decode_parameter_mesh(responses());
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  ASSERT_EQ(mesh->discs.size(), 2u);
  for (const ParameterDisc& disc : mesh->discs) {
    EXPECT_EQ(disc.positions[1][0], 1);
    EXPECT_EQ(disc.uv[2][1], 1);
    EXPECT_EQ(disc.border, (std::vector<std::uint32_t>{0, 1, 2}));
    EXPECT_EQ(disc.border_cuts, (std::vector<std::uint8_t>{1, 0, 1}));
  }
  EXPECT_EQ(mesh->discs[1].faces[0], 1u);
}

TEST(ParameterMesh, RefusesWhatMakesNoSense) {
  using Chunk = v1::ParameterDiscChunk;
  const std::vector<std::function<void(Chunk&)>> spoilers = {
      [](Chunk& c) { c.set_disc(2); },
      [](Chunk& c) { c.set_disc(0); },
      [](Chunk& c) { c.mutable_positions()->pop_back(); },
      [](Chunk& c) { c.mutable_uv()->resize(32); },
      [](Chunk& c) {
        c.set_triangles(bytes_of<std::uint32_t>({0, 1, 3}));
      },
      [](Chunk& c) { c.clear_triangles(); },
      [](Chunk& c) { c.set_faces(bytes_of<std::uint32_t>({2})); },
      [](Chunk& c) { c.set_area_ratios(bytes_of<double>({-1})); },
      [](Chunk& c) { c.set_area_ratios(bytes_of<double>({std::nan("")})); },
      [](Chunk& c) {
        c.set_border(bytes_of<std::uint32_t>({0, 1, 9}));
      },
      [](Chunk& c) { c.mutable_border_cuts()->pop_back(); },
      [](Chunk& c) {
        c.set_uv(bytes_of<double>({0, 0, 1.5, 0, 0, 1}));
      }};
  for (std::size_t i = 0; i < spoilers.size(); ++i) {
    auto spoilt = responses();
    spoilers[i](*spoilt[3].mutable_chunk());
    EXPECT_EQ(decode_parameter_mesh(spoilt).status().code(), absl::StatusCode::kDataLoss) << i;
  }
  EXPECT_FALSE(decode_parameter_mesh({}).ok());
  auto cut_short = responses();
  cut_short.pop_back();
  EXPECT_FALSE(decode_parameter_mesh(cut_short).ok());
}

}  // namespace
}  // namespace curvecast::client
