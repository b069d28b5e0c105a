#include <cstdint>
#include <limits>

#include "tests/core/mesh_io/mesh_writers.h"
#include "tests/support/hostile_files.h"

namespace curvecast::testing {
namespace {

const std::string kBinary = "ply\nformat binary_little_endian 1.0\n";
const std::string kBig = "ply\nformat binary_big_endian 1.0\n";
const std::string kText = "ply\nformat ascii 1.0\n";
const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";
const std::string kList = "property list uchar int vertex_indices\n";
const std::string kEnd = "end_header\n";
const std::string kThree = "0 0 0\n1 0 0\n0 1 0\n";

std::string vertices(const std::string& count) { return "element vertex " + count + "\n" + kXyz; }
std::string faces(const std::string& count) { return "element face " + count + "\n" + kList; }

/// A text of three vertices and the faces, or whatever, in `body`.
std::string text(const std::string& face_header, const std::string& body) {
  return kText + vertices("3") + face_header + kEnd + kThree + body;
}

std::string three_points(bool big_endian = false) {
  std::string bytes;
  for (const float x : {0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F}) append(bytes, x, big_endian);
  return bytes;
}

/// A triangle, or as many corners as `indices` has, behind three vertices.
std::string binary_face(const std::vector<int>& indices, bool big_endian = false) {
  std::string file = (big_endian ? kBig : kBinary) + vertices("3") + faces("1") + kEnd + three_points(big_endian);
  file += static_cast<char>(indices.size());
  for (const int index : indices) append(file, index, big_endian);
  return file;
}

std::string strips(const std::string& format, const std::string& types) {
  return format + vertices("3") + "element tristrips 1\nproperty list " + types + " vertex_indices\n" + kEnd;
}

void add_headers(std::vector<HostileFile>& files) {
  const auto refuse = [&](const char* what, const std::string& bytes, const std::string& words) {
    files.push_back({.what = std::string("PLY header ") + what, .name = "a.ply", .bytes = bytes, .words = {words}});
  };
  refuse("of three letters", "ply", "'end_header' is missing");
  refuse("with another magic", "plywood\n", "line 1: a PLY file begins with a line 'ply'");
  refuse("without an end", kBinary, "line 3: the file ends within the header ('end_header' is missing)");
  refuse("without a format", "ply\nend_header\n", "line 2: the header has no line 'format'");
  refuse("of an unknown format", "ply\nformat text 1.0\nend_header\n",
         "line 2: expected ascii, binary_little_endian or binary_big_endian");
  refuse("without elements", kBinary + kEnd, "no element 'vertex'");
  refuse("with a property of nothing", kBinary + "property float x\n" + kEnd,
         "line 3: a property stands before the first element");
  refuse("without a count", kBinary + "element vertex\n" + kEnd, "line 3: expected the number of elements");
  refuse("with a negative count", kBinary + "element vertex -1\n" + kEnd, "line 3: the number of elements is negative");
  refuse("with a count beyond 64 bits", kBinary + "element vertex 99999999999999999999\n" + kEnd,
         "line 3: expected the number of elements, found '99999999999999999999'");
  refuse("with a count of a thousand digits", kBinary + "element vertex " + std::string(1'000, '9') + "\n" + kEnd,
         "line 3: expected the number of elements");
  refuse("with a fraction as a count", kBinary + "element vertex 3.5\n" + kEnd, "line 3: expected the number of elements");
  refuse("of an unknown type", kBinary + "element vertex 1\nproperty half x\n" + kEnd, "line 4: expected a type");
  refuse("with a fractional list length", kBinary + "element vertex 1\nproperty list float int x\n" + kEnd,
         "line 4: the length of a list has to be of an integer type");
  refuse("with an unprintable keyword", kBinary + "element vertex 1\nsurprise\x01\n" + kEnd,
         "line 4: unknown keyword in the header: 'surprise\\x01'");
  refuse("with a keyword of a megabyte", kBinary + std::string(1'000'000, 'k') + "\n" + kEnd, "line 3: unknown keyword");
  refuse("with two coordinates", kBinary + "element vertex 1\nproperty float x\nproperty float y\n" + kEnd + "0123456789ab",
         "the element 'vertex' has no property 'z'");
  refuse(
      "with lists as coordinates",
      kBinary + "element vertex 1\nproperty list uchar float x\nproperty float y\nproperty float z\n" + kEnd + "0123456789abcd",
      "the element 'vertex' has no property 'x'");
  refuse("without coordinates", kBinary + "element vertex 5\n" + kEnd, "no properties x, y and z");
  refuse("with two vertex elements", kBinary + vertices("0") + vertices("0") + kEnd, "more than one element 'vertex'");
  refuse("without an index list", text("element face 1\nproperty list uchar float vertex_indices\n", ""),
         "the element 'face' has no list 'vertex_indices'");
  refuse("with no vertices or faces", kBinary + vertices("0") + faces("0") + kEnd, "no faces");
  refuse("without faces", kBinary + vertices("0") + kEnd, "no faces");
  refuse("in UTF-16", std::string("\xff\xfep\0l\0y\0\n\0", 10), "line 1: a PLY file begins with a line 'ply'");
  std::string many = kText;
  for (int i = 0; i < 20'000; ++i) many += "element vertex 0\n" + kXyz;
  refuse("with 20,000 elements", many + kEnd, "more than one element 'vertex'");
  std::string wide = kText + vertices("3");
  for (int i = 0; i < 10'000; ++i) wide += "property float p" + std::to_string(i) + "\n";
  refuse("with 10,000 properties and no values", wide + faces("1") + kEnd + kThree, "vertex 0: the file ends here at the latest");
}

void add_claims(std::vector<HostileFile>& files) {
  const auto refuse = [&](const char* what, const std::string& bytes, const std::string& words) {
    files.push_back({.what = std::string("PLY claim of ") + what, .name = "a.ply", .bytes = bytes, .words = {words}});
  };
  const std::string at_latest = "the file ends here at the latest, but its header claims ";
  refuse("10^9 vertices", kBinary + vertices("1000000000") + kEnd + "0123456789ab", "vertex 1: " + at_latest + "1000000000");
  refuse("2^32 vertices", kBinary + vertices("4294967296") + kEnd, "more than 4294967295 vertices");
  refuse("2^63 - 1 vertices", kBig + vertices("9223372036854775807") + kEnd, "more than 4294967295 vertices");
  refuse("10^9 vertices in text", kText + vertices("1000000000") + kEnd + kThree, "vertex 3: " + at_latest);
  refuse("10^9 faces", kBinary + faces("1000000000") + vertices("0") + kEnd + "\x03", "face 1: " + at_latest);
  refuse("2^63 - 1 faces", kBinary + vertices("3") + faces("9223372036854775807") + kEnd + three_points(),
         "face 0: " + at_latest);
  refuse("2^63 - 1 elements of no interest",
         kBinary + "element a 9223372036854775807\nproperty double b\n" + vertices("1") + kEnd, "a 0: " + at_latest);
  refuse("255 corners", kBinary + faces("1") + vertices("9") + kEnd + "\xff", "face 0: the file ends here");
  refuse("2^32 - 1 items of no interest",
         kBinary + "element a 1\nproperty list uint double b\n" + vertices("1") + kEnd + "\xff\xff\xff\xff",
         "a 0: the file ends");
  refuse("a negative length", kBinary + "element a 1\nproperty list char uchar b\n" + vertices("1") + kEnd + "\xff",
         "a 0: a list has the negative length -1");
  refuse("2^31 - 1 corners",
         kBinary + vertices("3") + "element face 1\nproperty list int int vertex_indices\n" + kEnd + three_points() +
             std::string("\xff\xff\xff\x7f\0\0\0\0", 8),
         "face 0: the file ends here");
  refuse("10^9 corners in text", text(faces("1"), "1000000000 0 1 2\n"),
         "expected a number of face 0 of 1, but the file ends here");
  refuse("2^63 - 1 corners in text", text(faces("1"), "9223372036854775807 0 1 2\n"), "expected a number of face 0 of 1");
  refuse("2^64 corners in text", text(faces("1"), "18446744073709551616 0 1 2\n"), "line 13: expected a number of face 0 of 1");
  refuse("-3 corners in text", text(faces("1"), "-3 0 1 2\n"), "line 13: a list has the negative length -3");
  refuse("2^32 - 1 corners of strips", strips(kBinary, "uint int") + three_points() + "\xff\xff\xff\xff",
         "tristrips 0: the file ends");
  refuse("2^63 - 1 texture coordinates",
         text("element face 1\nproperty list int float texcoord\n" + kList, "9223372036854775807 0 0\n"),
         "line 15: expected a number of face 0 of 1, but the file ends here");
}

void add_values(std::vector<HostileFile>& files) {
  const auto refuse = [&](const char* what, const std::string& bytes, const std::string& words) {
    files.push_back({.what = std::string("PLY with ") + what, .name = "a.ply", .bytes = bytes, .words = {words}});
  };
  const auto use = [&](const char* what, const std::string& bytes, const std::vector<std::string>& words = {}) {
    files.push_back({.what = std::string("PLY with ") + what, .name = "a.ply", .bytes = bytes, .usable = true, .words = words});
  };
  FileMesh mesh = tetrahedron();
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    mesh.vertices[2][1] = bad;
    const std::string which = bad > 0 ? "infinity" : "NaN";
    for (const char* format : {"binary_little_endian", "binary_big_endian"}) {
      for (const char* type : {"float", "double"}) {
        for (const bool extras : {false, true}) {
          refuse((which + " as a " + type + ", " + format + (extras ? ", among much else" : "")).c_str(),
                 ply_file(mesh, {.format = format, .coordinate = type, .extras = extras}),
                 "vertex 2: a coordinate is not a finite number");
        }
      }
    }
    refuse((which + " in text").c_str(), ply_file(mesh, {.format = "ascii"}), "line 14: a coordinate is not a finite number");
  }
  mesh = pyramid();
  mesh.faces[3][1] = 99;
  const std::string out = "vertex index 99 is out of range (the file has 5 vertices)";
  refuse("an index out of range", ply_file(mesh), "face 3: " + out);
  refuse("an index out of range, big endian, among much else", ply_file(mesh, {.format = "binary_big_endian", .extras = true}),
         "face 3: " + out);
  refuse("an index out of range in text", ply_file(mesh, {.format = "ascii"}), "line 20: " + out);
  refuse("a negative index", binary_face({0, -1, 2}), "face 0: vertex index -1 is out of range (the file has 3 vertices)");
  refuse("the largest index", binary_face({0, 1, INT32_MAX}, true), "face 0: vertex index 2147483647 is out of range");
  refuse("an index of 2^63 in text", text(faces("1"), "3 0 1 9223372036854775808\n"),
         "line 13: expected a number of face 0 of 1");
  refuse("a word as a number", kText + vertices("3") + faces("1") + kEnd + "0 0 0\n1 0 zero\n0 1 0\n",
         "line 11: expected a number of vertex 1 of 3, found 'zero'");
  refuse("a bad strip", strips(kText, "int int") + kThree + "4 0 1 -2 2\n", "line 13: vertex index -2 is out of range");
  refuse("a strip that only ends", strips(kText, "int int") + kThree + "5 -1 -1 -1 -1 -1\n", "no faces");
  refuse("degenerate faces only", binary_face({1, 1, 2}), "the mesh has no face with an area (all 1 are degenerate)");
  refuse("a face of two corners", binary_face({0, 1}), "no faces");
  refuse("a body of another byte order",
         kBig + vertices("3") + faces("1") + kEnd + three_points() + std::string("\3\0\0\0\0\1\0\0\0\2\0\0\0", 13),
         "face 0: vertex index 16777216 is out of range");
  for (const std::size_t part : {4, 8, 12, 15}) {
    const std::string whole = ply_file(pyramid());
    const std::size_t length = whole.size() * part / 16;
    refuse(("only " + std::to_string(part) + " of 16 parts").c_str(), whole.substr(0, length),
           part < 12 ? "line " : ": the file ends here");
  }
  use("coordinates of 5,000 digits",
      kText + vertices("3") + faces("1") + kEnd + "0 0 0\n1 0 0\n0 0." + std::string(5'000, '3') + " 0\n3 0 1 2\n");
  refuse("a coordinate of a megabyte of digits",
         kText + vertices("3") + faces("1") + kEnd + "0 0 " + std::string(1'000'000, '9') + "\n", "line 10: ");
  refuse("coordinates of 1e999", kText + vertices("3") + faces("1") + kEnd + "0 0 0\n1 0 1e999\n0 1 0\n3 0 1 2\n",
         "line 11: a coordinate is not a finite number");
  use("a comment of a megabyte",
      kText + "comment " + std::string(1'000'000, 'c') + "\n" + vertices("3") + faces("1") + kEnd + kThree + "3 0 1 2\n");
  use("mixed line ends",
      "ply\r\nformat ascii 1.0\nelement vertex 3\r\n" + kXyz + faces("1") + kEnd + "0 0 0\r1 0 0\r\n0 1 0\n3 0 1 2");
  std::string scalars = kText + vertices("3"), zeros;
  for (int i = 0; i < 2'000; ++i) {
    scalars += "property float p" + std::to_string(i) + "\n";
    zeros += " 0";
  }
  scalars += faces("1") + kEnd + "0 0 0" + zeros + "\n1 0 0" + zeros + "\n0 1 0" + zeros + "\n3 0 1 2\n";
  use("2,000 scalars", scalars, {"1936 are left out"});
  std::string long_face = text(faces("1"), "60000");
  for (int i = 0; i < 60'000; ++i) long_face.append(" ").append(std::to_string(i % 3));
  use("a face that goes round 20,000 times", long_face + "\n");
}

}  // namespace

std::vector<HostileFile> hostile_ply_files() {
  std::vector<HostileFile> files;
  add_headers(files);
  add_claims(files);
  add_values(files);
  return files;
}

}  // namespace curvecast::testing
