// Mesh files made in memory, for the tests of the readers.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <sstream>
#include <string>
#include <vector>

namespace curvecast {

struct FileMesh {
  std::vector<std::array<double, 3>> vertices;
  std::vector<std::vector<int>> faces;
};

/// A pyramid with a quadrilateral base; every coordinate is exact as a float and as a short decimal.
inline FileMesh pyramid() {
  return {{{0, 0, 0}, {1.5, 0, 0}, {1.5, 2.25, -0.125}, {0, 2.25, 0}, {0.75, 1, 3.5}},
          {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {3, 2, 1, 0}}};
}

inline FileMesh tetrahedron() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
}

template <class T>
void append(std::string& out, T value, bool big_endian = false) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  if (big_endian) std::reverse(bytes, bytes + sizeof(T));
  out.append(bytes, sizeof(T));
}

/// Appends `value` as the PLY type `name`, one of char uchar short ushort int uint float double.
inline void append_as(std::string& out, const std::string& name, double value, bool big_endian) {
  if (name == "char") append(out, static_cast<std::int8_t>(value), big_endian);
  if (name == "uchar") append(out, static_cast<std::uint8_t>(value), big_endian);
  if (name == "short") append(out, static_cast<std::int16_t>(value), big_endian);
  if (name == "ushort") append(out, static_cast<std::uint16_t>(value), big_endian);
  if (name == "int") append(out, static_cast<std::int32_t>(value), big_endian);
  if (name == "uint") append(out, static_cast<std::uint32_t>(value), big_endian);
  if (name == "float") append(out, static_cast<float>(value), big_endian);
  if (name == "double") append(out, value, big_endian);
}

struct PlyStyle {
  std::string format = "binary_little_endian";
  std::string coordinate = "float";
  std::string count = "uchar";
  std::string index = "int";
  std::string list = "vertex_indices";
  bool extras = false;  // other properties around, other elements before, between and behind, and the order z x y
};

inline std::string ply_file(const FileMesh& mesh, const PlyStyle& style = {}) {
  const bool text = style.format == "ascii";
  const bool big = style.format == "binary_big_endian";
  std::string body;
  const auto put = [&](const std::string& type, double value, char behind = ' ') {
    if (!text) return append_as(body, type, value, big);
    std::ostringstream number;
    number << value << behind;
    body += number.str();
  };
  std::ostringstream header;
  header << "ply\nformat " << style.format << " 1.0\ncomment made for a test\nobj_info none\n";
  if (style.extras) {
    header << "element camera 2\nproperty list ushort double matrix\nproperty float fov\n";
    for (int length : {3, 0}) {
      put("ushort", length);
      for (int i = 0; i < length; ++i) put("double", 0.5 * i);
      put("float", 60, '\n');
    }
  }
  header << "element vertex " << mesh.vertices.size() << "\n";
  if (style.extras) {
    header << "property uchar red\nproperty " << style.coordinate << " z\nproperty " << style.coordinate
           << " x\nproperty double quality\nproperty " << style.coordinate << " y\nproperty short id\n";
  } else {
    for (const char* axis : {"x", "y", "z"}) header << "property " << style.coordinate << " " << axis << "\n";
  }
  for (const auto& v : mesh.vertices) {
    if (style.extras) {
      put("uchar", 200);
      put(style.coordinate, v[2]);
      put(style.coordinate, v[0]);
      put("double", 0.25);
      put(style.coordinate, v[1]);
      put("short", -7, '\n');
    } else {
      for (int axis = 0; axis < 3; ++axis) put(style.coordinate, v[axis], axis == 2 ? '\n' : ' ');
    }
  }
  if (style.extras) {
    header << "element nothing 1000000000\nelement edge 1\nproperty int vertex1\nproperty int vertex2\n";
    put("int", 0);
    put("int", 1, '\n');
  }
  header << "element face " << mesh.faces.size() << "\n";
  if (style.extras) header << "property float weight\nproperty list uchar float texcoord\n";
  header << "property list " << style.count << " " << style.index << " " << style.list << "\n";
  if (style.extras) header << "property uchar flags\n";
  for (const auto& face : mesh.faces) {
    if (style.extras) {
      put("float", 1);
      put("uchar", 2);
      put("float", 0.5);
      put("float", 0.25);
    }
    put(style.count, static_cast<double>(face.size()));
    for (std::size_t i = 0; i < face.size(); ++i) put(style.index, face[i], !style.extras && i + 1 == face.size() ? '\n' : ' ');
    if (style.extras) put("uchar", 1, '\n');
  }
  if (style.extras) {
    header << "element material 1\nproperty float shine\n";
    put("float", 1, '\n');
  }
  header << "end_header\n";
  return header.str() + body;
}

inline std::string obj_file(const FileMesh& mesh) {
  std::ostringstream out;
  out << "# made for a test\nmtllib none.mtl\no thing\n";
  for (const auto& v : mesh.vertices) out << "v " << v[0] << " " << v[1] << " " << v[2] << "\n";
  out << "vt 0.5 0.5\nvn 0 0 1\ng part\nusemtl none\ns off\n";
  for (const auto& face : mesh.faces) {
    out << "f";
    for (int index : face) out << " " << index + 1;
    out << "\n";
  }
  return out.str();
}

inline std::string off_file(const FileMesh& mesh) {
  std::ostringstream out;
  out << "OFF\n" << mesh.vertices.size() << " " << mesh.faces.size() << " 0\n";
  for (const auto& v : mesh.vertices) out << v[0] << " " << v[1] << " " << v[2] << "\n";
  for (const auto& face : mesh.faces) {
    out << face.size();
    for (int index : face) out << " " << index;
    out << "\n";
  }
  return out.str();
}

/// Triangles only.
inline std::string binary_stl_file(const FileMesh& mesh, std::string title = "made for a test") {
  title.resize(80);
  append(title, static_cast<std::uint32_t>(mesh.faces.size()));
  for (const auto& face : mesh.faces) {
    for (int i = 0; i < 3; ++i) append(title, 0.0F);
    for (int index : face) {
      for (double coordinate : mesh.vertices[index]) append(title, static_cast<float>(coordinate));
    }
    append(title, std::uint16_t{0});
  }
  return title;
}

inline std::string text_stl_file(const FileMesh& mesh) {
  std::ostringstream out;
  out << "solid made for a test\n";
  for (const auto& face : mesh.faces) {
    out << "  facet normal nan 0 0\n    outer loop\n";
    for (int index : face) {
      const auto& v = mesh.vertices[index];
      out << "      vertex " << v[0] << " " << v[1] << " " << v[2] << "\n";
    }
    out << "    endloop\n  endfacet\n";
  }
  out << "endsolid made for a test\n";
  return out.str();
}

}  // namespace curvecast
