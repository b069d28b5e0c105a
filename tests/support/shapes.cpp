#include "tests/support/shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "core/base/random.h"
#include "core/mesh/repair.h"

namespace curvecast::testing {
namespace {

constexpr double kTau = 2 * std::numbers::pi;

void add_polygon(PolygonSoup& soup, std::initializer_list<std::uint32_t> corners) {
  if (soup.polygon_begin.empty()) soup.polygon_begin.push_back(0);
  soup.indices.insert(soup.indices.end(), corners);
  soup.polygon_begin.push_back(static_cast<std::uint32_t>(soup.indices.size()));
}

/// Quads between `rows` rows of `columns` vertices each; rows and columns may close.
void add_grid(PolygonSoup& soup, int rows, int columns, bool rows_close, bool columns_close) {
  const auto id = [&](int r, int c) { return static_cast<std::uint32_t>((r % rows) * columns + c % columns); };
  for (int r = 0; r < rows - !rows_close; ++r) {
    for (int c = 0; c < columns - !columns_close; ++c) {
      add_polygon(soup, {id(r, c), id(r, c + 1), id(r + 1, c + 1)});
      add_polygon(soup, {id(r, c), id(r + 1, c + 1), id(r + 1, c)});
    }
  }
}

}  // namespace

PolygonSoup disc(int rings, int sectors) {
  PolygonSoup soup;
  soup.positions.emplace_back(0, 0, 0);
  for (int r = 1; r <= rings; ++r) {
    for (int s = 0; s < sectors; ++s) {
      const double a = kTau * s / sectors;
      soup.positions.emplace_back(r * std::cos(a) / rings, r * std::sin(a) / rings, 0);
    }
  }
  const auto id = [&](int r, int s) { return static_cast<std::uint32_t>(1 + (r - 1) * sectors + s % sectors); };
  for (int s = 0; s < sectors; ++s) {
    add_polygon(soup, {0, id(1, s), id(1, s + 1)});
    for (int r = 1; r < rings; ++r) {
      add_polygon(soup, {id(r, s), id(r + 1, s), id(r + 1, s + 1)});
      add_polygon(soup, {id(r, s), id(r + 1, s + 1), id(r, s + 1)});
    }
  }
  return soup;
}

PolygonSoup square(int cells) {
  std::vector<Vec3d> positions;
  std::vector<std::vector<std::uint32_t>> triangles;
  const auto side = static_cast<std::uint32_t>(cells);
  for (int y = 0; y <= cells; ++y) {
    for (int x = 0; x <= cells; ++x) positions.push_back(Vec3d(x, y, 0) / cells);
  }
  for (std::uint32_t y = 0; y < side; ++y) {
    for (std::uint32_t x = 0; x < side; ++x) {
      const std::uint32_t v = y * (side + 1) + x;
      triangles.push_back({v, v + 1, v + side + 2});
      triangles.push_back({v, v + side + 2, v + side + 1});
    }
  }
  return soup_of(std::move(positions), triangles);
}

PolygonSoup sphere(int rings, int sectors, double radius) {
  PolygonSoup soup;
  for (int r = 1; r < rings; ++r) {
    const double polar = std::numbers::pi * r / rings;
    for (int s = 0; s < sectors; ++s) {
      const double a = kTau * s / sectors;
      soup.positions.emplace_back(radius * std::sin(polar) * std::cos(a), radius * std::sin(polar) * std::sin(a),
                                  radius * std::cos(polar));
    }
  }
  const auto north = static_cast<std::uint32_t>(soup.positions.size());
  soup.positions.emplace_back(0, 0, radius);
  soup.positions.emplace_back(0, 0, -radius);
  const auto id = [&](int r, int s) { return static_cast<std::uint32_t>(r * sectors + s % sectors); };
  for (int s = 0; s < sectors; ++s) {
    add_polygon(soup, {north, id(0, s), id(0, s + 1)});
    add_polygon(soup, {north + 1, id(rings - 2, s + 1), id(rings - 2, s)});
    for (int r = 0; r + 2 < rings; ++r) {
      add_polygon(soup, {id(r, s), id(r + 1, s), id(r + 1, s + 1)});
      add_polygon(soup, {id(r, s), id(r + 1, s + 1), id(r, s + 1)});
    }
  }
  return soup;
}

PolygonSoup torus(int rings, int sectors, double tube) {
  PolygonSoup soup;
  for (int r = 0; r < rings; ++r) {
    const double around = kTau * r / rings;
    for (int s = 0; s < sectors; ++s) {
      const double a = kTau * s / sectors;
      const double reach = 1 + tube * std::cos(a);
      soup.positions.emplace_back(reach * std::cos(around), reach * std::sin(around), tube * std::sin(a));
    }
  }
  add_grid(soup, rings, sectors, true, true);
  for (std::size_t i = 0; i < soup.indices.size(); i += 3) std::swap(soup.indices[i + 1], soup.indices[i + 2]);
  return soup;
}

PolygonSoup open_cylinder(int rings, int sectors, double height) {
  PolygonSoup soup;
  for (int r = 0; r < rings; ++r) {
    for (int s = 0; s < sectors; ++s) {
      const double a = kTau * s / sectors;
      soup.positions.emplace_back(std::cos(a), std::sin(a), height * r / (rings - 1));
    }
  }
  add_grid(soup, rings, sectors, false, true);
  return soup;
}

PolygonSoup mobius_strip(int sectors) {
  PolygonSoup soup;
  for (int s = 0; s < sectors; ++s) {
    const double a = kTau * s / sectors;
    for (const double side : {-0.3, 0.3}) {
      const double reach = 1 + side * std::cos(a / 2);
      soup.positions.emplace_back(reach * std::cos(a), reach * std::sin(a), side * std::sin(a / 2));
    }
  }
  const auto count = static_cast<std::uint32_t>(sectors);
  for (std::uint32_t s = 0; s < count; ++s) {
    const bool wraps = s + 1 == count;
    const std::uint32_t a = 2 * s, b = 2 * s + 1;
    const std::uint32_t c = wraps ? 0 : 2 * s + 3, d = wraps ? 1 : 2 * s + 2;
    add_polygon(soup, {a, b, c});
    add_polygon(soup, {a, c, d});
  }
  return soup;
}

PolygonSoup perforated_slab(int n, int m) {
  PolygonSoup soup;
  std::map<std::array<int, 3>, std::uint32_t> ids;
  const auto id = [&](int x, int y, int z) {
    const auto [it, fresh] = ids.try_emplace({x, y, z}, static_cast<std::uint32_t>(soup.positions.size()));
    if (fresh) soup.positions.emplace_back(x, y, z);
    return it->second;
  };
  const auto solid = [&](int x, int y) { return x >= 0 && y >= 0 && x < n && y < m && !(x % 2 == 1 && y % 2 == 1); };
  for (int x = 0; x < n; ++x) {
    for (int y = 0; y < m; ++y) {
      if (!solid(x, y)) continue;
      add_polygon(soup, {id(x, y, 1), id(x + 1, y, 1), id(x + 1, y + 1, 1), id(x, y + 1, 1)});
      add_polygon(soup, {id(x, y, 0), id(x, y + 1, 0), id(x + 1, y + 1, 0), id(x + 1, y, 0)});
      if (!solid(x - 1, y)) add_polygon(soup, {id(x, y, 0), id(x, y, 1), id(x, y + 1, 1), id(x, y + 1, 0)});
      if (!solid(x + 1, y)) add_polygon(soup, {id(x + 1, y, 0), id(x + 1, y + 1, 0), id(x + 1, y + 1, 1), id(x + 1, y, 1)});
      if (!solid(x, y - 1)) add_polygon(soup, {id(x, y, 0), id(x + 1, y, 0), id(x + 1, y, 1), id(x, y, 1)});
      if (!solid(x, y + 1)) add_polygon(soup, {id(x, y + 1, 0), id(x, y + 1, 1), id(x + 1, y + 1, 1), id(x + 1, y + 1, 0)});
    }
  }
  return soup;
}

PolygonSoup cube() { return perforated_slab(1, 1); }

PolygonSoup tetrahedron() {
  PolygonSoup soup;
  soup.positions = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  add_polygon(soup, {0, 1, 2});
  add_polygon(soup, {0, 2, 3});
  add_polygon(soup, {0, 3, 1});
  add_polygon(soup, {1, 3, 2});
  return soup;
}

PolygonSoup single_triangle() {
  PolygonSoup soup;
  soup.positions = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}};
  add_polygon(soup, {0, 1, 2});
  return soup;
}

PolygonSoup icosphere(int level, double radius) {
  const double g = std::numbers::phi;
  std::vector<Vec3d> places = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                               {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  std::vector<std::vector<std::uint32_t>> faces = {
      {0, 11, 5}, {0, 5, 1}, {0, 1, 7}, {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
      {3, 9, 4},  {3, 4, 2}, {3, 2, 6}, {3, 6, 8},  {3, 8, 9},   {4, 9, 5}, {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int i = 0; i < level; ++i) {
    std::map<std::array<std::uint32_t, 2>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [it, fresh] = middles.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<std::uint32_t>(places.size()));
      if (fresh) places.emplace_back((places[a].normalized() + places[b].normalized()).normalized());
      return it->second;
    };
    std::vector<std::vector<std::uint32_t>> finer;
    for (const auto& f : faces) {
      const std::uint32_t a = middle(f[0], f[1]), b = middle(f[1], f[2]), c = middle(f[2], f[0]);
      finer.insert(finer.end(), {{f[0], a, c}, {f[1], b, a}, {f[2], c, b}, {a, b, c}});
    }
    faces = std::move(finer);
  }
  for (Vec3d& p : places) p = radius * p.normalized();
  return soup_of(std::move(places), faces);
}

PolygonSoup soup_of(std::vector<Vec3d> positions, const std::vector<std::vector<std::uint32_t>>& polygons) {
  PolygonSoup soup;
  soup.positions = std::move(positions);
  soup.polygon_begin.push_back(0);
  for (const std::vector<std::uint32_t>& polygon : polygons) {
    soup.indices.insert(soup.indices.end(), polygon.begin(), polygon.end());
    soup.polygon_begin.push_back(static_cast<std::uint32_t>(soup.indices.size()));
  }
  return soup;
}

PolygonSoup merged(const PolygonSoup& a, const PolygonSoup& b) {
  PolygonSoup soup = a;
  const auto shift = static_cast<std::uint32_t>(a.positions.size());
  const auto corners = static_cast<std::uint32_t>(a.indices.size());
  soup.positions.insert(soup.positions.end(), b.positions.begin(), b.positions.end());
  for (const std::uint32_t v : b.indices) soup.indices.push_back(v + shift);
  for (std::size_t p = 1; p < b.polygon_begin.size(); ++p) soup.polygon_begin.push_back(b.polygon_begin[p] + corners);
  return soup;
}

PolygonSoup translated(PolygonSoup soup, const Vec3d& by) {
  for (Vec3d& p : soup.positions) p += by;
  return soup;
}

PolygonSoup scaled(PolygonSoup soup, double factor) {
  for (Vec3d& p : soup.positions) p *= factor;
  return soup;
}

PolygonSoup unshared(const PolygonSoup& soup) {
  PolygonSoup result = soup;
  result.positions.clear();
  for (std::uint32_t& v : result.indices) {
    result.positions.push_back(soup.positions[v]);
    v = static_cast<std::uint32_t>(result.positions.size() - 1);
  }
  result.shares_vertices = false;
  return result;
}

PolygonSoup filtered(const PolygonSoup& soup, const std::function<bool(std::size_t)>& keep) {
  std::vector<std::vector<std::uint32_t>> polygons;
  for (std::size_t p = 0; p < soup.polygon_count(); ++p) {
    if (keep(p)) polygons.emplace_back(&soup.indices[soup.polygon_begin[p]], &soup.indices[0] + soup.polygon_begin[p + 1]);
  }
  return soup_of(soup.positions, polygons);
}

PolygonSoup jittered(PolygonSoup soup, double amount) {
  std::uint64_t counter = 0;
  for (Vec3d& p : soup.positions) {
    for (int axis = 0; axis < 3; ++axis) p[axis] += amount * (2 * random_unit(1, counter++) - 1);
  }
  return soup;
}

TriangleMesh make_mesh(const PolygonSoup& soup) {
  absl::StatusOr<RepairedMesh> repaired = repair(soup);
  if (!repaired.ok()) throw std::runtime_error(std::string(repaired.status().message()));
  return std::move(repaired->mesh);
}

namespace {

void write_polygons(const PolygonSoup& soup, std::ostream& out) {
  for (std::size_t p = 0; p < soup.polygon_count(); ++p) {
    out << soup.polygon_begin[p + 1] - soup.polygon_begin[p];
    for (std::uint32_t i = soup.polygon_begin[p]; i < soup.polygon_begin[p + 1]; ++i) out << ' ' << soup.indices[i];
    out << '\n';
  }
}

}  // namespace

std::string to_off(const PolygonSoup& soup) {
  std::ostringstream out;
  out.precision(17);
  out << "OFF\n" << soup.positions.size() << ' ' << soup.polygon_count() << " 0\n";
  for (const Vec3d& p : soup.positions) out << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
  write_polygons(soup, out);
  return out.str();
}

std::string to_ply(const PolygonSoup& soup) {
  std::ostringstream out;
  out.precision(17);
  out << "ply\nformat ascii 1.0\nelement vertex " << soup.positions.size() << '\n';
  for (const char* axis : {"x", "y", "z"}) out << "property double " << axis << '\n';
  for (const ScalarAttribute& scalar : soup.attributes.scalars) out << "property float " << scalar.name << '\n';
  out << "element face " << soup.polygon_count() << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (std::size_t v = 0; v < soup.positions.size(); ++v) {
    const Vec3d& p = soup.positions[v];
    out << p.x() << ' ' << p.y() << ' ' << p.z();
    for (const ScalarAttribute& scalar : soup.attributes.scalars) out << ' ' << scalar.values[v];
    out << '\n';
  }
  write_polygons(soup, out);
  return out.str();
}

}  // namespace curvecast::testing
