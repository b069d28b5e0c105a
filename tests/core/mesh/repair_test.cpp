#include "core/mesh/repair.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "core/flatten/union_find.h"
#include "core/mesh/topology.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;
using ::testing::HasSubstr;

RepairedMesh repaired(const PolygonSoup& soup) {
  absl::StatusOr<RepairedMesh> result = repair(soup);
  EXPECT_TRUE(result.ok()) << result.status();
  return result.ok() ? *std::move(result) : RepairedMesh{};
}

void expect_refused(const PolygonSoup& soup, const std::string& message) {
  const absl::StatusOr<RepairedMesh> result = repair(soup);
  ASSERT_FALSE(result.ok()) << message;
  EXPECT_EQ(result.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(result.status().message()), HasSubstr(message));
}

/// Twins that lie against each other, every vertex one fan of faces, nothing left over.
void expect_manifold(const TriangleMesh& mesh) {
  const auto halfedges = static_cast<std::uint32_t>(3 * mesh.face_count());
  ASSERT_EQ(mesh.twins.size(), halfedges);
  std::vector<std::uint32_t> first_corner(mesh.vertex_count(), kNone);
  UnionFind fans(halfedges);  // corners joined by an edge of both
  for (std::uint32_t h = 0; h < halfedges; ++h) {
    ASSERT_LT(mesh.from(h), mesh.vertex_count());
    ASSERT_NE(mesh.from(h), mesh.to(h)) << "halfedge " << h;
    const std::uint32_t t = mesh.twins[h];
    if (t == kNone) continue;
    ASSERT_LT(t, halfedges);
    ASSERT_EQ(mesh.twins[t], h) << "halfedge " << h;
    ASSERT_NE(t / 3, h / 3) << "halfedge " << h;
    ASSERT_EQ(mesh.from(t), mesh.to(h)) << "halfedge " << h;
    ASSERT_EQ(mesh.to(t), mesh.from(h)) << "halfedge " << h;
    fans.unite(h, next_halfedge(t));
  }
  for (std::uint32_t h = 0; h < halfedges; ++h) {
    std::uint32_t& first = first_corner[mesh.from(h)];
    if (first == kNone) first = h;
    ASSERT_EQ(fans.find(h), fans.find(first)) << "vertex " << mesh.from(h) << " joins two fans";
  }
  EXPECT_EQ(std::count(first_corner.begin(), first_corner.end(), kNone), 0) << "vertices without a face";
}

std::array<Vec3d, 3> places(const TriangleMesh& mesh, std::size_t f) {
  const Triangle& t = mesh.triangles[f];
  return {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
}

std::array<Vec3d, 3> places(const PolygonSoup& soup, std::size_t p) {
  const std::uint32_t* v = &soup.indices[soup.polygon_begin[p]];
  return {soup.positions[v[0]], soup.positions[v[1]], soup.positions[v[2]]};
}

/// The same corners in the same turn, from whichever corner.
bool same_turn(const std::array<Vec3d, 3>& a, std::array<Vec3d, 3> b) {
  for (int i = 0; i < 3; ++i) {
    if (a == b) return true;
    std::rotate(b.begin(), b.begin() + 1, b.end());
  }
  return false;
}

/// Every face's corners are those of the polygon that it comes from, in the order that its source tells; of greater polygons
/// some.
void expect_sources(const PolygonSoup& soup, const RepairedMesh& result) {
  for (std::uint32_t f = 0; f < result.mesh.face_count(); ++f) {
    const std::uint32_t p = result.sources.polygon(f);
    ASSERT_LT(p, soup.polygon_count()) << "face " << f;
    const std::array<Vec3d, 3> face = places(result.mesh, f);
    if (soup.polygon_begin[p + 1] - soup.polygon_begin[p] == 3) {
      std::array<Vec3d, 3> polygon = places(soup, p);
      if (result.sources.is_turned(f)) std::swap(polygon[1], polygon[2]);
      ASSERT_EQ(face, polygon) << "face " << f << " of polygon " << p;
      continue;
    }
    std::vector<Vec3d> corners;
    for (std::uint32_t i = soup.polygon_begin[p]; i < soup.polygon_begin[p + 1]; ++i) {
      corners.push_back(soup.positions[soup.indices[i]]);
    }
    for (const Vec3d& corner : face) ASSERT_NE(std::find(corners.begin(), corners.end(), corner), corners.end()) << "face " << f;
  }
}

double area_of(const PolygonSoup& triangles) {
  double sum = 0;
  for (std::size_t p = 0; p < triangles.polygon_count(); ++p) {
    const auto [a, b, c] = places(triangles, p);
    sum += 0.5 * (b - a).cross(c - a).norm();
  }
  return sum;
}

std::uint64_t faults(const RepairReport& r) {
  return r.triangulated_polygons + r.degenerate_faces + r.duplicate_faces + r.welded_vertices + r.unused_vertices +
         r.flipped_faces + r.nonmanifold_edges + r.split_vertices;
}

void append(PolygonSoup& soup, const std::vector<std::uint32_t>& polygon) {
  soup.indices.insert(soup.indices.end(), polygon.begin(), polygon.end());
  soup.polygon_begin.push_back(static_cast<std::uint32_t>(soup.indices.size()));
}

TEST(Repair, LeavesSoundMeshesAlone) {
  for (const PolygonSoup& soup : {disc(3, 8), sphere(8, 12), torus(9, 7), open_cylinder(4, 9), tetrahedron(), single_triangle(),
                                  merged(sphere(5, 6), translated(torus(5, 5), {5, 0, 0})), icosphere(2)}) {
    const RepairedMesh result = repaired(soup);
    expect_manifold(result.mesh);
    EXPECT_EQ(faults(result.report), 0u);
    EXPECT_TRUE(result.sources.codes().empty());
    EXPECT_EQ(result.mesh.vertex_count(), soup.positions.size());
    ASSERT_EQ(result.mesh.face_count(), soup.polygon_count());
    for (std::size_t f = 0; f < soup.polygon_count(); ++f) {
      EXPECT_TRUE(same_turn(places(soup, f), places(result.mesh, f))) << "face " << f;
    }
    EXPECT_NEAR(surface_area(result.mesh), area_of(soup), 1e-12 * area_of(soup));
  }
}

TEST(Repair, TurnsAMinorityOfFlippedFacesBack) {
  std::uint64_t counter = 0;
  for (const PolygonSoup& soup : {sphere(12, 16), torus(11, 9), disc(6, 13), open_cylinder(7, 15)}) {
    PolygonSoup broken = soup;
    std::uint64_t flipped = 0;
    for (std::size_t p = 0; p < soup.polygon_count(); ++p) {
      if (random_unit(1, counter++) >= 0.4) continue;
      std::swap(broken.indices[3 * p + 1], broken.indices[3 * p + 2]);
      ++flipped;
    }
    ASSERT_LT(2 * flipped, soup.polygon_count());
    const RepairedMesh result = repaired(broken);
    expect_manifold(result.mesh);
    EXPECT_EQ(result.report.flipped_faces, flipped);
    EXPECT_EQ(faults(result.report), flipped);
    expect_sources(broken, result);
    ASSERT_EQ(result.mesh.face_count(), soup.polygon_count());
    for (std::size_t f = 0; f < soup.polygon_count(); ++f) {
      EXPECT_TRUE(same_turn(places(soup, f), places(result.mesh, f))) << "face " << f;
    }
  }
}

TEST(Repair, KeepsTheMajoritysOrientationOfEachComponent) {
  // The first face is among the few that disagree; the second component is as it should be.
  PolygonSoup soup = merged(sphere(6, 8), translated(sphere(6, 8), {4, 0, 0}));
  std::swap(soup.indices[1], soup.indices[2]);
  const RepairedMesh result = repaired(soup);
  expect_manifold(result.mesh);
  EXPECT_EQ(result.report.flipped_faces, 1u);
  double volume = 0;
  for (std::size_t f = 0; f < result.mesh.face_count(); ++f) {
    const auto [a, b, c] = places(result.mesh, f);
    volume += a.dot(b.cross(c)) / 6;
  }
  EXPECT_GT(volume, 6);  // of 8.4 for two round ones
}

TEST(Repair, OpensAMobiusStripAtOneEdge) {
  for (const int sectors : {3, 10, 41}) {
    const PolygonSoup soup = mobius_strip(sectors);
    const RepairedMesh result = repaired(soup);
    expect_manifold(result.mesh);
    EXPECT_EQ(result.report.nonmanifold_edges, 1u);
    EXPECT_EQ(result.report.split_vertices, 2u);
    EXPECT_EQ(result.mesh.face_count(), soup.polygon_count());
    EXPECT_NEAR(surface_area(result.mesh), area_of(soup), 1e-12);
    const Topology topology = analyse_topology(result.mesh);
    EXPECT_EQ(topology.components, 1u);
    EXPECT_EQ(topology.boundary_loops, 1u);
    EXPECT_EQ(topology.genus, 0u);
  }
}

TEST(Repair, SplitsAnEdgeOfThreeFaces) {
  const PolygonSoup book = soup_of({{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, -1, 0}}, {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}});
  const RepairedMesh result = repaired(book);
  expect_manifold(result.mesh);
  EXPECT_EQ(result.mesh.face_count(), 3u);
  EXPECT_EQ(result.report.nonmanifold_edges, 1u);
  EXPECT_EQ(result.report.split_vertices, result.mesh.vertex_count() - 5);
  EXPECT_NEAR(surface_area(result.mesh), area_of(book), 1e-12);
}

TEST(Repair, SeparatesTetrahedraThatShareAVertex) {
  const PolygonSoup soup = soup_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}},
                                   {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}, {0, 4, 5}, {0, 6, 4}, {0, 5, 6}, {4, 6, 5}});
  const RepairedMesh result = repaired(soup);
  expect_manifold(result.mesh);
  EXPECT_EQ(result.mesh.vertex_count(), 8u);
  EXPECT_EQ(result.report.split_vertices, 1u);
  EXPECT_EQ(result.report.nonmanifold_edges, 0u);
  const Topology topology = analyse_topology(result.mesh);
  EXPECT_EQ(topology.components, 2u);
  EXPECT_EQ(topology.boundary_loops, 0u);
}

TEST(Repair, SeparatesTetrahedraThatShareAnEdge) {
  const PolygonSoup soup = soup_of({{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}},
                                   {{0, 1, 2}, {1, 0, 3}, {0, 2, 3}, {1, 3, 2}, {0, 1, 4}, {1, 0, 5}, {0, 4, 5}, {1, 5, 4}});
  const RepairedMesh result = repaired(soup);
  expect_manifold(result.mesh);
  EXPECT_EQ(result.report.nonmanifold_edges, 1u);
  EXPECT_EQ(result.report.split_vertices, 2u);
  EXPECT_EQ(result.mesh.face_count(), 8u);
  EXPECT_EQ(analyse_topology(result.mesh).components, 2u);
  EXPECT_NEAR(surface_area(result.mesh), area_of(soup), 1e-12);
}

TEST(Repair, GivesEveryFanAtABowTieItsOwnVertex) {
  PolygonSoup soup = soup_of({{0, 0, 0}}, {});
  for (std::uint32_t fan = 0; fan < 4; ++fan) {  // two triangles each
    for (const double turn : {0.0, 0.3, 0.6}) {
      soup.positions.emplace_back(std::cos(1.5 * fan + turn), std::sin(1.5 * fan + turn), 0);
    }
    append(soup, {0, 3 * fan + 1, 3 * fan + 2});
    append(soup, {0, 3 * fan + 2, 3 * fan + 3});
  }
  const RepairedMesh result = repaired(soup);
  expect_manifold(result.mesh);
  EXPECT_EQ(result.report.split_vertices, 3u);
  EXPECT_EQ(result.mesh.vertex_count(), 16u);
  EXPECT_EQ(analyse_topology(result.mesh).boundary_loops, 4u);
}

TEST(Repair, DropsDuplicateFaces) {
  const PolygonSoup good = sphere(8, 10);
  PolygonSoup soup = good;
  for (std::uint32_t p = 0; p < 30; p += 3) {
    const std::uint32_t *v = &good.indices[3 * p], a = v[0], b = v[1], c = v[2];
    if (p % 2 == 0) append(soup, {b, c, a});
    if (p % 2 == 1) append(soup, {c, b, a});
  }
  const RepairedMesh result = repaired(soup);
  expect_manifold(result.mesh);
  EXPECT_EQ(result.report.duplicate_faces, 10u);
  EXPECT_EQ(faults(result.report), 10u);
  expect_sources(soup, result);
  ASSERT_EQ(result.mesh.face_count(), good.polygon_count());
  for (std::size_t f = 0; f < good.polygon_count(); ++f) EXPECT_TRUE(same_turn(places(good, f), places(result.mesh, f)));
}

TEST(Repair, DropsADuplicateOfALoneFace) {
  PolygonSoup soup = single_triangle();
  append(soup, {0, 1, 2});
  const RepairedMesh result = repaired(soup);
  EXPECT_EQ(result.report.duplicate_faces, 1u);
  EXPECT_EQ(result.mesh.face_count(), 1u);
  EXPECT_NEAR(surface_area(result.mesh), area_of(single_triangle()), 1e-12);
}

TEST(Repair, DropsDegenerateFacesAndKeepsSlivers) {
  const PolygonSoup soup =
      soup_of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {0, 0, 0}, {1, 1e-14, 0}, {1, 1e-7, 3}, {2, 0, 3}, {0, 0, 3}},
              {{0, 1, 1},     // repeated corner
               {1, 1, 1},     // one corner
               {0, 1, 2},     // on a line
               {0, 4, 3},     // two corners at one place
               {0, 2, 5},     // nearly on a line
               {0, 0, 3, 3},  // a quad of two places
               {8, 7, 6},     // thin, with an area
               {0, 2, 3}});
  const RepairedMesh result = repaired(soup);
  expect_manifold(result.mesh);
  EXPECT_EQ(result.report.degenerate_faces, 6u);
  expect_sources(soup, result);
  ASSERT_EQ(result.mesh.face_count(), 2u);
  EXPECT_TRUE(same_turn(places(result.mesh, 0), {soup.positions[8], soup.positions[7], soup.positions[6]}));
  EXPECT_TRUE(same_turn(places(result.mesh, 1), {soup.positions[0], soup.positions[2], soup.positions[3]}));
  EXPECT_EQ(result.report.unused_vertices, 3u);
}

TEST(Repair, TellsWhichPolygonsFacesAreWhereABlockDiffersFromTheOthers) {
  // More polygons than a thread takes at once; one alone, late, is no triangle, and so only the faces behind it have other
  // numbers.
  PolygonSoup soup = torus(400, 300);
  const std::size_t odd = 200'000;
  ASSERT_GT(soup.polygon_count(), odd);
  soup.indices[3 * odd + 1] = soup.indices[3 * odd];
  const RepairedMesh result = repaired(soup);
  EXPECT_EQ(result.report.degenerate_faces, 1u);
  ASSERT_EQ(result.mesh.face_count(), soup.polygon_count() - 1);
  EXPECT_EQ(result.sources.polygon(odd - 1), odd - 1);
  EXPECT_EQ(result.sources.polygon(odd), odd + 1);
  expect_sources(soup, result);
}

TEST(Repair, TriangulatesQuadsAndConcavePolygons) {
  const RepairedMesh box = repaired(cube());
  expect_manifold(box.mesh);
  expect_sources(cube(), box);
  EXPECT_EQ(box.report.triangulated_polygons, 6u);
  EXPECT_EQ(box.mesh.face_count(), 12u);
  EXPECT_NEAR(surface_area(box.mesh), 6, 1e-12);

  // A prism over an L of area 3 and perimeter 8.
  std::vector<Vec3d> positions;
  const std::vector<Vec2d> outline = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  for (const double z : {0.0, 1.0}) {
    for (const Vec2d& p : outline) positions.emplace_back(p.x(), p.y(), z);
  }
  std::vector<std::vector<std::uint32_t>> polygons = {{5, 4, 3, 2, 1, 0}, {6, 7, 8, 9, 10, 11}};
  for (std::uint32_t i = 0; i < 6; ++i) polygons.push_back({i, (i + 1) % 6, (i + 1) % 6 + 6, i + 6});
  const RepairedMesh prism = repaired(soup_of(positions, polygons));
  expect_manifold(prism.mesh);
  EXPECT_EQ(prism.report.triangulated_polygons, 8u);
  EXPECT_EQ(prism.report.degenerate_faces, 0u);
  EXPECT_EQ(prism.report.flipped_faces, 0u);
  EXPECT_NEAR(surface_area(prism.mesh), 2 * 3 + 8, 1e-12);
  const Topology topology = analyse_topology(prism.mesh);
  EXPECT_EQ(topology.boundary_loops, 0u);
  EXPECT_EQ(topology.genus, 0u);
}

TEST(Repair, IgnoresCornersRepeatedInARow) {
  const RepairedMesh result = repaired(soup_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 1, 1, 2, 0}}));
  EXPECT_EQ(result.mesh.face_count(), 1u);
  EXPECT_EQ(faults(result.report), 0u);
}

TEST(Repair, WeldsSoups) {
  for (const PolygonSoup& soup : {sphere(10, 14), torus(8, 9), open_cylinder(4, 11)}) {
    const RepairedMesh whole = repaired(soup);
    const RepairedMesh welded = repaired(unshared(soup));
    expect_manifold(welded.mesh);
    EXPECT_EQ(welded.report.welded_vertices, 3 * soup.polygon_count() - soup.positions.size());
    EXPECT_EQ(faults(welded.report), welded.report.welded_vertices);
    EXPECT_EQ(welded.mesh.vertex_count(), soup.positions.size());
    ASSERT_EQ(welded.mesh.face_count(), soup.polygon_count());
    for (std::size_t f = 0; f < soup.polygon_count(); ++f) EXPECT_TRUE(same_turn(places(soup, f), places(welded.mesh, f)));
    EXPECT_EQ(analyse_topology(welded.mesh).genus, analyse_topology(whole.mesh).genus);
    EXPECT_EQ(analyse_topology(welded.mesh).boundary_loops, analyse_topology(whole.mesh).boundary_loops);
  }
}

TEST(Repair, WeldsBordersInFormatsThatShareVertices) {
  for (const PolygonSoup& whole : {tetrahedron(), sphere(9, 12), torus(8, 7), open_cylinder(4, 11)}) {
    PolygonSoup soup = unshared(whole);  // a PLY or OBJ whose triangles own their vertices
    soup.shares_vertices = true;
    const RepairedMesh result = repaired(soup);
    expect_manifold(result.mesh);
    EXPECT_EQ(result.report.welded_vertices, soup.positions.size() - whole.positions.size());
    EXPECT_EQ(faults(result.report), result.report.welded_vertices);
    EXPECT_EQ(analyse_topology(result.mesh).components, 1u);
    EXPECT_EQ(analyse_topology(result.mesh).boundary_loops, analyse_topology(repaired(whole).mesh).boundary_loops);
  }
}

TEST(Repair, LeavesClosedSurfacesAloneThatTouch) {
  // Two closed cubes side by side share the places of four vertices; so do two equal spheres.
  for (const auto& [soup, other] : {std::pair{cube(), translated(cube(), {1, 0, 0})}, std::pair{sphere(7, 8), sphere(7, 8)}}) {
    const RepairedMesh result = repaired(merged(soup, other));
    EXPECT_EQ(result.report.welded_vertices, 0u);
    EXPECT_EQ(result.report.duplicate_faces, 0u);
    EXPECT_EQ(analyse_topology(result.mesh).components, 2u);
    EXPECT_EQ(analyse_topology(result.mesh).boundary_loops, 0u);
  }
}

TEST(Repair, WeldsBothZeros) {
  PolygonSoup soup = soup_of({{0.0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0, 0, -0.0}, {0, 1, 0}, {-1, 0, 0}}, {{0, 1, 2}, {3, 4, 5}});
  soup.shares_vertices = false;
  const RepairedMesh result = repaired(soup);
  EXPECT_EQ(result.report.welded_vertices, 2u);
  EXPECT_EQ(analyse_topology(result.mesh).components, 1u);
}

TEST(Repair, DropsUnusedVertices) {
  PolygonSoup soup = tetrahedron();
  soup.positions.insert(soup.positions.begin() + 2, Vec3d(1e9, 1e9, 1e9));
  soup.positions.emplace_back(-1e9, 0, 0);
  for (std::uint32_t& v : soup.indices) v += v >= 2;
  const RepairedMesh result = repaired(soup);
  expect_manifold(result.mesh);
  EXPECT_EQ(result.report.unused_vertices, 2u);
  EXPECT_EQ(faults(result.report), 2u);
  EXPECT_EQ(result.mesh.vertex_count(), 4u);
  EXPECT_LT(bounding_box(result.mesh).diagonal(), 4);

  soup = unshared(tetrahedron());
  soup.positions.emplace_back(7, 7, 7);
  soup.positions.emplace_back(7, 7, 7);
  const RepairedMesh welded = repaired(soup);
  EXPECT_EQ(welded.report.welded_vertices + welded.report.unused_vertices, 10u);
  EXPECT_EQ(welded.mesh.vertex_count(), 4u);
}

TEST(Repair, RefusesMeshesWithoutArea) {
  expect_refused({}, "no face");
  expect_refused(soup_of({}, {}), "no face");
  expect_refused(soup_of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}, {0, 0, 1}}), "no face");
}

TEST(Repair, RefusesBoxesThatFloatsCannotHold) {
  const PolygonSoup soup = tetrahedron();
  for (const double factor : {1e-14, 1e-100, 1e16, 1e100, 1e300}) {
    const absl::StatusOr<RepairedMesh> result = repair(scaled(soup, factor));
    EXPECT_EQ(result.status().code(), absl::StatusCode::kInvalidArgument) << factor;
  }
  expect_refused(scaled(soup, 1e-14), "scale");
  expect_refused(scaled(soup, 1e16), "scale");
  for (const double factor : {1e-12, 1e-6, 1e6, 1e14}) {
    EXPECT_NEAR(surface_area(repaired(scaled(soup, factor)).mesh) / (factor * factor), area_of(soup), 1e-9) << factor;
  }
}

TEST(Repair, MakesAManifoldOfAnySoup) {
  // Few vertices and many random faces: crowded edges, duplicates, bow-ties and one-sided surfaces all at once.
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    std::uint64_t counter = 0;
    const auto random = [&](std::size_t n) { return static_cast<std::uint32_t>(n * random_unit(seed, counter++)); };
    const std::size_t vertices = 5 + seed % 20;
    std::vector<Vec3d> positions(vertices);
    for (Vec3d& p : positions) p = {random(1000) * 1.0, random(1000) * 1.0, random(1000) * 1.0};
    std::vector<std::vector<std::uint32_t>> polygons(60);
    std::map<std::set<std::uint32_t>, std::uint64_t> kinds;
    for (auto& polygon : polygons) {
      polygon = {random(vertices), random(vertices), random(vertices)};
      ++kinds[{polygon.begin(), polygon.end()}];
    }
    std::uint64_t distinct = 0, degenerate = 0, duplicate = 0;
    double area = 0;
    for (const auto& [corners, count] : kinds) {
      if (corners.size() < 3) {
        degenerate += count;
        continue;
      }
      ++distinct;
      duplicate += count - 1;
      const std::vector<std::uint32_t> v(corners.begin(), corners.end());
      area += 0.5 * (positions[v[1]] - positions[v[0]]).cross(positions[v[2]] - positions[v[0]]).norm();
    }
    const PolygonSoup soup = soup_of(positions, polygons);
    const RepairedMesh result = repaired(soup);
    expect_manifold(result.mesh);
    expect_sources(soup, result);
    EXPECT_EQ(result.mesh.face_count(), distinct) << "seed " << seed;
    EXPECT_EQ(result.report.degenerate_faces, degenerate) << "seed " << seed;
    EXPECT_EQ(result.report.duplicate_faces, duplicate) << "seed " << seed;
    EXPECT_NEAR(surface_area(result.mesh), area, 1e-9 * area) << "seed " << seed;
  }
}

TEST(Repair, StopsWhenCancelled) {
  const std::atomic<bool> cancel = true;
  ExecutionContext context;
  context.cancel = &cancel;
  EXPECT_EQ(repair(sphere(8, 8), context).status().code(), absl::StatusCode::kCancelled);
}

}  // namespace
}  // namespace curvecast
