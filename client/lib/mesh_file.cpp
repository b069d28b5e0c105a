// SPDX-License-Identifier: Apache-2.0
#include "client/lib/mesh_file.h"

#include <absl/strings/ascii.h>
#include <absl/strings/str_format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <limits>
#include <new>

#include "client/lib/drc_mesh.h"
#include "client/lib/file_bytes.h"
#include "proto/formats/ply_name.h"

namespace curvecast::client {
namespace {

static_assert(std::endian::native == std::endian::little, "records are little endian and written as they lie in memory");

using Place = std::array<double, 3>;

Place place_of(const Mesh& mesh, std::size_t v) {
  Place p;
  for (int axis = 0; axis < 3; ++axis) p[axis] = mesh.vertices.origin[axis] + double{mesh.vertices.positions[v][axis]};
  return p;
}

bool needs_doubles(const Mesh& mesh) { return mesh.vertices.origin != Place{}; }

template <typename T>
void put(std::string& out, const T& value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// In as many digits as reading it back exactly takes.
template <typename T>
void put_text(std::string& out, T value) {
  char digits[32];
  out.append(digits, std::to_chars(std::begin(digits), std::end(digits), value).ptr);
}

void put_place(std::string& out, const Mesh& mesh, std::size_t v) {
  const Place p = place_of(mesh, v);
  for (int axis = 0; axis < 3; ++axis) {
    if (axis > 0) out += ' ';
    needs_doubles(mesh) ? put_text(out, p[axis]) : put_text(out, static_cast<float>(p[axis]));
  }
}

absl::StatusOr<std::string> make_ply(const Mesh& mesh) {
  const Points& vertices = mesh.vertices;
  const bool doubles = needs_doubles(mesh);
  std::string out = absl::StrFormat("ply\nformat binary_little_endian 1.0\nelement vertex %d\n", vertices.size());
  for (const char* axis : {"x", "y", "z"}) absl::StrAppendFormat(&out, "property %s %s\n", doubles ? "double" : "float", axis);
  if (!vertices.normals.empty()) out += "property float nx\nproperty float ny\nproperty float nz\n";
  if (!vertices.colours.empty()) out += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  for (const ScalarColumn& scalar : vertices.scalars)
    absl::StrAppendFormat(&out, "property float %s\n", formats::ply_name(scalar.name));
  absl::StrAppendFormat(&out, "element face %d\nproperty list uchar uint vertex_indices\nend_header\n", mesh.triangles.size());
  out.reserve(out.size() + 40 * vertices.size() + 13 * mesh.triangles.size());
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const Place p = place_of(mesh, v);
    for (const double x : p) doubles ? put(out, x) : put(out, static_cast<float>(x));
    if (!vertices.normals.empty()) put(out, vertices.normals[v]);
    if (!vertices.colours.empty()) put(out, vertices.colours[v]);
    for (const ScalarColumn& scalar : vertices.scalars) put(out, scalar.values[v]);
  }
  for (const auto& triangle : mesh.triangles) {
    out += '\3';
    put(out, triangle);
  }
  return out;
}

absl::StatusOr<std::string> make_obj(const Mesh& mesh) {
  const Points& vertices = mesh.vertices;
  std::string out;
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    out += "v ";
    put_place(out, mesh, v);
    if (!vertices.colours.empty()) {
      for (const std::uint8_t channel : vertices.colours[v]) absl::StrAppendFormat(&out, " %.4g", channel / 255.0);
    }
    out += '\n';
  }
  for (const auto& [x, y, z] : vertices.normals) {
    out += "vn ";
    put_text(out, x);
    out += ' ';
    put_text(out, y);
    out += ' ';
    put_text(out, z);
    out += '\n';
  }
  for (const auto& [a, b, c] : mesh.triangles) {
    if (vertices.normals.empty()) {
      absl::StrAppendFormat(&out, "f %d %d %d\n", a + 1, b + 1, c + 1);
    } else {
      absl::StrAppendFormat(&out, "f %d//%d %d//%d %d//%d\n", a + 1, a + 1, b + 1, b + 1, c + 1, c + 1);
    }
  }
  return out;
}

absl::StatusOr<std::string> make_off(const Mesh& mesh) {
  std::string out = absl::StrFormat("OFF\n%d %d 0\n", mesh.vertices.size(), mesh.triangles.size());
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    put_place(out, mesh, v);
    out += '\n';
  }
  for (const auto& [a, b, c] : mesh.triangles) absl::StrAppendFormat(&out, "3 %d %d %d\n", a, b, c);
  return out;
}

absl::StatusOr<std::string> make_stl(const Mesh& mesh) {
  std::string out = "binary STL";
  out.resize(80, ' ');
  put(out, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& triangle : mesh.triangles) {
    const Place a = place_of(mesh, triangle[0]), b = place_of(mesh, triangle[1]), c = place_of(mesh, triangle[2]);
    Place p, q, n;
    for (int axis = 0; axis < 3; ++axis) p[axis] = b[axis] - a[axis], q[axis] = c[axis] - a[axis];
    for (int axis = 0; axis < 3; ++axis) {
      n[axis] = p[(axis + 1) % 3] * q[(axis + 2) % 3] - p[(axis + 2) % 3] * q[(axis + 1) % 3];
    }
    const double length = std::hypot(n[0], n[1], n[2]);
    for (const double x : n) put(out, static_cast<float>(length > 0 ? x / length : 0));
    for (const Place& corner : {a, b, c}) {
      for (const double x : corner) put(out, static_cast<float>(x));
    }
    put(out, std::uint16_t{0});
  }
  return out;
}

/// What sRGB is in linear light, which glTF wants.
float linear(std::uint8_t channel) {
  const double x = channel / 255.0;
  return static_cast<float>(x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4));
}

absl::StatusOr<std::string> make_glb(const Mesh& mesh) {
  const Points& vertices = mesh.vertices;
  const std::size_t n = vertices.size();
  std::string binary;
  std::string views, accessors, attributes;
  int count = 0;
  const auto add = [&](std::size_t begin, int target, int component, std::size_t elements, const char* type,
                       const std::string& bounds) {
    const char* comma = count > 0 ? "," : "";
    absl::StrAppendFormat(&views, R"(%s{"buffer":0,"byteOffset":%d,"byteLength":%d,"target":%d})", comma, begin,
                          binary.size() - begin, target);
    absl::StrAppendFormat(&accessors, R"(%s{"bufferView":%d,"componentType":%d,"count":%d,"type":"%s"%s})", comma, count,
                          component, elements, type, bounds);
    return count++;
  };
  constexpr int kVertices = 34962, kIndices = 34963, kFloat = 5126, kUint = 5125;
  std::array<float, 3> low, high;
  low.fill(std::numeric_limits<float>::infinity());
  high.fill(-std::numeric_limits<float>::infinity());
  std::size_t begin = 0;
  for (const auto& p : vertices.positions) {
    put(binary, p);
    for (int axis = 0; axis < 3; ++axis) low[axis] = std::min(low[axis], p[axis]), high[axis] = std::max(high[axis], p[axis]);
  }
  const std::string bounds =
      absl::StrFormat(R"(,"min":[%.9g,%.9g,%.9g],"max":[%.9g,%.9g,%.9g])", low[0], low[1], low[2], high[0], high[1], high[2]);
  absl::StrAppendFormat(&attributes, R"("POSITION":%d)", add(begin, kVertices, kFloat, n, "VEC3", bounds));
  if (!vertices.normals.empty()) {
    begin = binary.size();
    for (const auto& normal : vertices.normals) put(binary, normal);
    absl::StrAppendFormat(&attributes, R"(,"NORMAL":%d)", add(begin, kVertices, kFloat, n, "VEC3", ""));
  }
  if (!vertices.colours.empty()) {
    begin = binary.size();
    for (const auto& colour : vertices.colours) {
      for (const std::uint8_t channel : colour) put(binary, linear(channel));
    }
    absl::StrAppendFormat(&attributes, R"(,"COLOR_0":%d)", add(begin, kVertices, kFloat, n, "VEC3", ""));
  }
  begin = binary.size();
  for (const auto& triangle : mesh.triangles) put(binary, triangle);
  const int indices = add(begin, kIndices, kUint, 3 * mesh.triangles.size(), "SCALAR", "");
  const auto& [x, y, z] = vertices.origin;
  std::string json =
      absl::StrFormat(R"({"asset":{"version":"2.0","generator":"curvecast"},"scene":0,"scenes":[{"nodes":[0]}],)"
                      R"("nodes":[{"mesh":0,"translation":[%.17g,%.17g,%.17g]}],)"
                      R"("meshes":[{"primitives":[{"attributes":{%s},"indices":%d}]}],"buffers":[{"byteLength":%d}],)"
                      R"("bufferViews":[%s],"accessors":[%s]})",
                      x, y, z, attributes, indices, binary.size(), views, accessors);
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string out = "glTF";
  const auto chunk = [&out](const std::array<char, 4>& type, const std::string& bytes) {
    put(out, static_cast<std::uint32_t>(bytes.size()));
    put(out, type);
    out += bytes;
  };
  put(out, std::uint32_t{2});
  put(out, static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + binary.size()));
  chunk({'J', 'S', 'O', 'N'}, json);
  chunk({'B', 'I', 'N', '\0'}, binary);
  return out;
}

absl::StatusOr<std::string> make_drc_file(const Mesh& mesh) { return make_drc_mesh(mesh); }

using Make = absl::StatusOr<std::string> (*)(const Mesh& mesh);

Make maker_of(const std::string& path) {
  const std::string ending = absl::AsciiStrToLower(std::filesystem::path(path).extension().string());
  if (ending == ".ply") return make_ply;
  if (ending == ".obj") return make_obj;
  if (ending == ".off") return make_off;
  if (ending == ".stl") return make_stl;
  if (ending == ".glb") return make_glb;
  if (ending == ".drc") return make_drc_file;
  return nullptr;
}

}  // namespace

absl::Status check_mesh_ending(const std::string& path) {
  if (maker_of(path) != nullptr) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrFormat("%s: not a mesh file's name: it has to end in .ply, .obj, .off, .stl, .glb or .drc", path));
}

absl::Status write_mesh_file(const std::string& path, const Mesh& mesh) {
  if (absl::Status status = check_mesh_ending(path); !status.ok()) return status;
  try {
    const absl::StatusOr<std::string> bytes = maker_of(path)(mesh);
    if (bytes.ok()) return write_bytes(path, *bytes);
    return absl::Status(bytes.status().code(), absl::StrFormat("%s: %s", path, bytes.status().message()));
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError(absl::StrFormat("%s: not enough memory to write the mesh", path));
  }
}

}  // namespace curvecast::client
