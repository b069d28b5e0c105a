#include <limits>

#include "tests/core/mesh_io/mesh_writers.h"
#include "tests/support/hostile_files.h"

namespace curvecast::testing {
namespace {

const std::string kThree = "0 0 0\n1 0 0\n0 1 0\n";

std::string off(const std::string& counts, const std::string& behind) { return "OFF\n" + counts + "\n" + kThree + behind; }

void add_off(std::vector<HostileFile>& files) {
  const auto refuse = [&](const char* what, const std::string& bytes, const std::string& words) {
    files.push_back({.what = std::string("OFF ") + what, .name = "a.off", .bytes = bytes, .words = {words}});
  };
  const auto use = [&](const char* what, const std::string& bytes, const std::vector<std::string>& words = {}) {
    files.push_back({.what = std::string("OFF ") + what, .name = "a.off", .bytes = bytes, .usable = true, .words = words});
  };
  const std::string too_short = ", but the file is too short for more than";
  refuse("in binary", "OFF BINARY\n", "line 1: binary OFF is not supported");
  refuse("in n dimensions", "nOFF\n3\n3 1 0\n", "line 1: OFF in n dimensions is not supported");
  refuse("of a keyword", "OFF\n", "line 2: expected the number of vertices, but the file ends here");
  refuse("with a negative count", "OFF\n-3 1 0\n", "line 2: the number of vertices is negative");
  refuse("with 10^9 vertices and faces", off("1000000000 1000000000 0", ""),
         "line 2: the number of vertices is 1000000000" + too_short);
  refuse("with 10^9 faces", off("3 1000000000 0", ""), "line 2: the number of faces is 1000000000" + too_short);
  refuse("with 2^32 vertices", off("4294967296 1 0", ""), "line 2: the number of vertices is 4294967296" + too_short);
  refuse("with 2^63 - 1 faces", off("3 9223372036854775807 0", ""),
         "line 2: the number of faces is 9223372036854775807" + too_short);
  refuse("with 2^64 vertices", off("18446744073709551616 1 0", ""), "line 2: expected the number of vertices");
  refuse("with a count of a thousand digits", off(std::string(1'000, '1') + " 1 0", ""),
         "line 2: expected the number of vertices");
  refuse("with a face of 10^9 corners", off("3 1 0", "1000000000 0 1 2\n"),
         "expected a vertex index of face 0 of 1, but the file ends here");
  refuse("with a face of 2^63 - 1 corners", off("3 1 0", "9223372036854775807 0 1 2\n"),
         "expected a vertex index of face 0 of 1");
  refuse("with a face of -3 corners", off("3 1 0", "-3 0 1 2\n"), "line 6: face 0 has a negative number of corners");
  refuse("without faces", off("3 0 0", ""), "no faces");
  refuse("of degenerate faces", off("3 2 0", "3 0 0 1\n4 2 1 1 2\n"), "the mesh has no face with an area");
  refuse("with an index out of range", off("3 1 0", "3 0 1 3\n"),
         "line 6: vertex index 3 is out of range (the file has 3 vertices)");
  refuse("with a negative index", off("3 1 0", "3 0 1 -1\n"),
         "line 6: vertex index -1 is out of range (the file has 3 vertices)");
  refuse("with a point at infinity", "4OFF\n3 1 0\n0 0 0 1\n1 0 0 0\n0 1 0 1\n3 0 1 2\n",
         "line 4: a coordinate is not a finite number");
  refuse("with a NaN", "OFF\n3 1 0\n0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n", "line 4: a coordinate is not a finite number");
  refuse("with an infinity", "OFF\n3 1 0\n0 0 0\n1 inf 0\n0 1 0\n3 0 1 2\n", "line 4: a coordinate is not a finite number");
  refuse("that ends within its vertices", "OFF\n3 1 0\n0 0 0\n1 0 0\n0", "line 5: expected a coordinate of vertex 2 of 3");
  refuse("that ends within its faces", off("3 2 0", "3 0 1 2\n"), "expected the number of corners of face 1 of 2");
  refuse("of two megabytes of digits", "OFF\n" + std::string(2'000'000, '9'), "line 2: expected the number of vertices");
  refuse("with a word of two megabytes", off("3 1 0", std::string(2'000'000, 'x')),
         "line 6: expected the number of corners of face 0");
  use("with a comment of two megabytes", "OFF\n#" + std::string(2'000'000, '#') + "\n3 1 0\n" + kThree + "3 0 1 2\n");
  use("that lacks the colours it promises", "COFF\n3 1 0\n0 0 0 9 9\n1 0 0\n0 1 0 1 1 1\n3 0 1 2 nan inf 7\n",
      {"line 3: this vertex lacks some of the normal, colour and texture coordinates"});
  use("with colours that are no numbers",
      "COFF\n3 1 0\n0 0 0 nan inf -inf\n1 0 0 1e99 -1e99 0\n0 1 0 1 1 1\n3 0 1 2 1e999 nan 7\n");
  use("with mixed line ends", "OFF\r3 1 0\r\n0 0 0\n1 0 0\r0 1 0\n\n\r3 0 1 2");
}

void add_stl(std::vector<HostileFile>& files) {
  const auto refuse = [&](const char* what, const std::string& bytes, const std::string& words) {
    files.push_back({.what = std::string("STL ") + what, .name = "a.stl", .bytes = bytes, .words = {words}});
  };
  const auto use = [&](const char* what, const std::string& bytes) {
    files.push_back({.what = std::string("STL ") + what, .name = "a.stl", .bytes = bytes, .usable = true});
  };
  const std::string title(80, '\0');
  refuse("that claims 2139062143 triangles", title + "\x7f\x7f\x7f\x7f",
         "triangle 0: the file ends here, but its header claims 2139062143 triangles");
  refuse("that claims 10^9 triangles before one", title + std::string("\0\xca\x9a\x3b", 4) + std::string(50, '\0'),
         "triangle 1: the file ends here, but its header claims 1000000000 triangles");
  refuse("of a header", std::string(84, '\0'), "no faces");
  refuse("of a word", "short", "the file ends within the header of a binary STL");
  refuse("with a ring in place of a loop", "solid a\nfacet normal 0 0 1\nouter ring\n", "line 3: expected loop, found 'ring'");
  refuse("of nothing", "solid a\nendsolid\n", "no faces");
  refuse("with a misspelt facet", "solid a\nfacets\n", "line 2: expected facet or endsolid, found 'facets'");
  refuse("of a title of two megabytes", "solid " + std::string(2'000'000, 's'), "expected facet or endsolid");
  refuse("with a facet that never ends",
         "solid a\nfacet normal 0 0 1\nouter loop\n" + std::string(1'000'000, '\n') + "vertex 0 0",
         "line 1000004: expected a coordinate of a vertex, but the file ends here");
  refuse("of degenerate triangles",
         "solid a\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 0 0\nendloop\nendfacet\nendsolid\n",
         "the mesh has no face with an area");
  FileMesh mesh = tetrahedron();
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    mesh.vertices[2][1] = bad;
    const std::string which = bad > 0 ? "infinity" : "NaN";
    refuse(("with " + which).c_str(), binary_stl_file(mesh), "triangle 0: a coordinate is not a finite number");
    refuse(("with " + which + " in text").c_str(), text_stl_file(mesh), "line 5: a coordinate is not a finite number");
  }
  const std::string whole = binary_stl_file(tetrahedron());
  refuse("without its last byte", whole.substr(0, whole.size() - 1), "triangle 3: the file ends here");
  refuse("that ends within its header", whole.substr(0, 83), "the file ends within the header of a binary STL");
  const std::string text = text_stl_file(tetrahedron());
  refuse("that ends within a vertex", text.substr(0, text.find("vertex 0 1 0") + 9), "line 5: expected a coordinate of a vertex");
  refuse("without an end", text.substr(0, text.rfind("endsolid")), "line 30: expected facet or endsolid, but the file ends here");
  use("with normals that are words",
      "solid a\nfacet normal up and away\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n");
  use("with bytes behind its triangles", whole + std::string(1'000, 'x'));
  use("in text with a binary STL's title", binary_stl_file(tetrahedron(), "solid facet normal 0 0 0 outer loop"));
  use("with mixed line ends",
      "SOLID\r\nFACET NORMAL 0 0 1\rOUTER LOOP\nVERTEX 0 0 0\r\nVERTEX 1 0 0\rVERTEX 0 1 0\n\nENDLOOP ENDFACET\nENDSOLID");
}

void add_nothing(std::vector<HostileFile>& files) {
  const auto refuse = [&](const std::string& what, const std::string& name, const std::string& bytes, const std::string& words) {
    files.push_back({.what = what, .name = name, .bytes = bytes, .words = {words}});
  };
  for (const char* name : {"a.ply", "a.obj", "a.off", "a.stl", "a.gltf", "a.glb", "a"}) {
    refuse(std::string("an empty file called ") + name, name, "", "the file is empty");
  }
  std::string garbage;
  for (unsigned i = 0; i < 100'000; ++i) garbage += static_cast<char>((i * i * 2654435761U) >> 13);
  const std::string unknown =
      "neither the content nor the name tells the format; give a PLY, OBJ, OFF, STL, glTF, GLB or 3MF file";
  refuse("a text of no format", "a.txt", "hello", unknown);
  refuse("garbage of no format", "a", garbage, unknown);
  refuse("garbage as PLY", "a.ply", garbage, "line 1: a PLY file begins with a line 'ply'");
  refuse("garbage as OBJ", "a.obj", garbage, "no faces");
  refuse("garbage as OFF", "a.off", garbage, "expected the number of vertices");
  refuse("garbage as STL", "a.stl", garbage, "triangle ");
  refuse("garbage as glTF", "a.gltf", garbage, "line 1: the JSON is malformed");
  refuse("garbage as GLB", "a.glb", "glTF" + garbage, "GLB version ");
}

}  // namespace

std::vector<HostileFile> hostile_off_stl_files() {
  std::vector<HostileFile> files;
  add_off(files);
  add_stl(files);
  add_nothing(files);
  return files;
}

}  // namespace curvecast::testing
