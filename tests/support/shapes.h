// Generated shapes of every topology that the pipeline has to deal with.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/mesh/polygon_soup.h"
#include "core/mesh/triangle_mesh.h"

namespace curvecast::testing {

PolygonSoup disc(int rings, int sectors);                              // flat, one border loop
PolygonSoup square(int cells);                                         // flat, side 1; two triangles for each of cells^2
PolygonSoup sphere(int rings, int sectors, double radius = 1);         // closed, genus 0
PolygonSoup torus(int rings, int sectors, double tube = 0.3);          // closed, genus 1; ring radius 1
PolygonSoup open_cylinder(int rings, int sectors, double height = 2);  // two border loops; radius 1
PolygonSoup mobius_strip(int sectors);                                 // one-sided
/// A slab of n x m unit cells, one cell thick, with every other inner cell a hole: closed, genus ((n - 1) / 2) ((m - 1) / 2) for
/// odd n and m. Quads.
PolygonSoup perforated_slab(int n, int m);
/// The cube's 8 vertices and 6 quads.
PolygonSoup cube();
PolygonSoup tetrahedron();
PolygonSoup single_triangle();
PolygonSoup icosphere(int level, double radius = 1);  // closed, genus 0; 20 * 4^level nearly equal triangles

/// The given polygons over the given positions.
PolygonSoup soup_of(std::vector<Vec3d> positions, const std::vector<std::vector<std::uint32_t>>& polygons);

/// Both soups side by side in one, sharing nothing.
PolygonSoup merged(const PolygonSoup& a, const PolygonSoup& b);
PolygonSoup translated(PolygonSoup soup, const Vec3d& by);
PolygonSoup scaled(PolygonSoup soup, double factor);
/// Every polygon with vertices of its own, to be welded, as STL has them.
PolygonSoup unshared(const PolygonSoup& soup);
/// Only the polygons for which keep(p) holds; the positions stay.
PolygonSoup filtered(const PolygonSoup& soup, const std::function<bool(std::size_t)>& keep);
/// Every coordinate moved at random by up to `amount`, by the same numbers every time.
PolygonSoup jittered(PolygonSoup soup, double amount);

/// repair() of the soup; the test fails where that does.
TriangleMesh make_mesh(const PolygonSoup& soup);

/// The soup as the text of an OFF file.
std::string to_off(const PolygonSoup& soup);
/// The soup with its named values as the text of a PLY file.
std::string to_ply(const PolygonSoup& soup);

}  // namespace curvecast::testing
