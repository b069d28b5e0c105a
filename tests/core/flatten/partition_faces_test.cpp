#include "core/flatten/partition_faces.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <numeric>

#include "core/flatten/piece.h"
#include "core/mesh/topology.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

std::vector<std::uint32_t> all_faces(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> faces(mesh.face_count());
  std::iota(faces.begin(), faces.end(), 0u);
  return faces;
}

/// Every face lies in one part; parts are connected, and none is much larger than the others.
void expect_partition(const TriangleMesh& mesh, std::span<const std::uint32_t> faces, const std::vector<FacePart>& parts,
                      std::size_t count) {
  std::vector<std::uint32_t> together;
  for (const FacePart& part : parts) {
    ASSERT_FALSE(part.faces.empty());
    EXPECT_TRUE(std::is_sorted(part.faces.begin(), part.faces.end()));
    std::vector<std::uint32_t> labels;
    EXPECT_EQ(label_components(extract_piece(mesh, part.faces).twins, labels), 1u);
    EXPECT_LE(part.faces.size(), 2 * faces.size() / count + 8);
    together.insert(together.end(), part.faces.begin(), part.faces.end());
  }
  std::sort(together.begin(), together.end());
  EXPECT_TRUE(std::ranges::equal(together, faces));
}

/// How many parts have an edge in common with the one before.
std::size_t neighbours_on_the_way(const TriangleMesh& mesh, const std::vector<FacePart>& parts) {
  std::vector<std::size_t> part_of(mesh.face_count(), parts.size());
  for (std::size_t p = 0; p < parts.size(); ++p) {
    for (const std::uint32_t f : parts[p].faces) part_of[f] = p;
  }
  std::vector<bool> meets(parts.size(), false);
  for (std::uint32_t h = 0; h < mesh.twins.size(); ++h) {
    if (mesh.twins[h] == kNone) continue;
    const std::size_t here = part_of[h / 3], there = part_of[mesh.twins[h] / 3];
    if (there + 1 == here) meets[here] = true;
  }
  return static_cast<std::size_t>(std::count(meets.begin(), meets.end(), true));
}

TEST(PartitionFaces, NoneWhenCancelled) {
  const TriangleMesh mesh = testing::make_mesh(testing::icosphere(4));
  const std::atomic<bool> cancel = true;
  EXPECT_TRUE(partition_faces(mesh, all_faces(mesh), 7, {.cancel = &cancel}).empty());
}

TEST(PartitionFaces, ConnectedPartsOfAboutOneSizeWithEveryFaceOnce) {
  for (const PolygonSoup& soup : {testing::icosphere(5), testing::torus(60, 90), testing::open_cylinder(100, 30, 40),
                                  testing::perforated_slab(19, 19), testing::jittered(testing::square(80), 0.002)}) {
    const TriangleMesh mesh = testing::make_mesh(soup);
    const std::vector<std::uint32_t> faces = all_faces(mesh);
    for (const std::size_t count : {std::size_t{2}, std::size_t{7}, std::size_t{32}}) {
      const std::vector<FacePart> parts = partition_faces(mesh, faces, count);
      EXPECT_GE(parts.size(), count / 2);
      expect_partition(mesh, faces, parts, count);
    }
  }
}

TEST(PartitionFaces, TheWayGoesFromNeighbourToNeighbour) {
  for (const PolygonSoup& soup : {testing::icosphere(5), testing::torus(60, 90), testing::square(80)}) {
    const TriangleMesh mesh = testing::make_mesh(soup);
    const std::vector<FacePart> parts = partition_faces(mesh, all_faces(mesh), 24);
    EXPECT_GE(neighbours_on_the_way(mesh, parts) + 2, parts.size());  // all but the first, and one more at most
    EXPECT_FALSE(parts.front().entry || parts.back().exit);
    for (std::size_t p = 1; p < parts.size(); ++p) {
      ASSERT_TRUE(parts[p].entry && parts[p - 1].exit);
      EXPECT_EQ(*parts[p].entry, *parts[p - 1].exit);
    }
  }
}

TEST(PartitionFaces, BordersHaveNoTeeth) {
  // No face of a part has two sides on the border of one other part.
  const TriangleMesh mesh = testing::make_mesh(testing::jittered(testing::icosphere(5), 0.005));
  const std::vector<FacePart> parts = partition_faces(mesh, all_faces(mesh), 10);
  std::vector<std::size_t> part_of(mesh.face_count());
  for (std::size_t p = 0; p < parts.size(); ++p) {
    for (const std::uint32_t f : parts[p].faces) part_of[f] = p;
  }
  std::size_t teeth = 0;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const auto around = [&](std::uint32_t i) { return part_of[mesh.twins[3 * f + i] / 3]; };
    for (std::uint32_t i = 0; i < 3; ++i) teeth += around(i) != part_of[f] && around(i) == around((i + 1) % 3);
  }
  EXPECT_EQ(teeth, 0u);
}

TEST(PartitionFaces, WhatAPlaneCutsOffGoesToANeighbour) {
  // A comb: planes cut across its teeth, of which each piece is small.
  PolygonSoup comb = testing::square(60);
  comb = testing::filtered(comb, [&](std::size_t p) {
    Vec3d middle = Vec3d::Zero();
    for (std::size_t i = 0; i < 3; ++i) middle += comb.positions[comb.indices[3 * p + i]] / 3;
    return middle.y() < 0.1 || static_cast<int>(middle.x() * 60) % 2 == 0;
  });
  const TriangleMesh mesh = testing::make_mesh(comb);
  const std::vector<std::uint32_t> faces = all_faces(mesh);
  const std::vector<FacePart> parts = partition_faces(mesh, faces, 8);
  std::vector<std::uint32_t> together;
  for (const FacePart& part : parts) {
    std::vector<std::uint32_t> labels;
    EXPECT_EQ(label_components(extract_piece(mesh, part.faces).twins, labels), 1u);
    together.insert(together.end(), part.faces.begin(), part.faces.end());
  }
  std::sort(together.begin(), together.end());
  EXPECT_EQ(together, faces);
}

TEST(PartitionFaces, SomeFacesOfAMesh) {
  const TriangleMesh mesh = testing::make_mesh(testing::square(40));
  std::vector<std::uint32_t> faces;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const Triangle& t = mesh.triangles[f];
    if ((mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]).x() / 3 < 0.5) faces.push_back(f);
  }
  expect_partition(mesh, faces, partition_faces(mesh, faces, 5), 5);
}

TEST(PartitionFaces, AnyNumberOfThreadsGivesTheSame) {
  const TriangleMesh mesh = testing::make_mesh(testing::jittered(testing::icosphere(6), 0.002));
  std::vector<std::vector<FacePart>> results;
  for (const int threads : {1, 3, 8}) {
    tbb::task_arena arena(threads);
    arena.execute([&] { results.push_back(partition_faces(mesh, all_faces(mesh), 40)); });
  }
  for (const std::vector<FacePart>& parts : results) {
    ASSERT_EQ(parts.size(), results[0].size());
    for (std::size_t p = 0; p < parts.size(); ++p) {
      EXPECT_EQ(parts[p].faces, results[0][p].faces);
      EXPECT_EQ(parts[p].entry, results[0][p].entry);
    }
  }
}

TEST(PartitionFaces, AsManyPartsAsFacesAndFacesAtOnePlace) {
  const TriangleMesh cube = testing::make_mesh(testing::cube());
  expect_partition(cube, all_faces(cube), partition_faces(cube, all_faces(cube), 1'000'000), 12);
  const std::vector<FacePart> one = partition_faces(cube, all_faces(cube), 1);
  ASSERT_EQ(one.size(), 1u);
  EXPECT_FALSE(one[0].entry || one[0].exit);
  TriangleMesh point = testing::make_mesh(testing::icosphere(2));
  std::fill(point.positions.begin(), point.positions.end(), Vec3d(1, 2, 3));
  expect_partition(point, all_faces(point), partition_faces(point, all_faces(point), 1), 1);
  EXPECT_FALSE(partition_faces(point, all_faces(point), 4).empty());
}

}  // namespace
}  // namespace curvecast
