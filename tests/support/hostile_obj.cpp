#include <cmath>

#include "tests/core/mesh_io/mesh_writers.h"
#include "tests/support/hostile_files.h"

namespace curvecast::testing {
namespace {

const std::string kThree = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
const std::string kTriangle = kThree + "f 1 2 3\n";

/// A flat star of `corners` corners, one polygon.
std::string star(int corners) {
  std::string file, face = "f";
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * 3.141592653589793 * i / corners, radius = i % 2 == 0 ? 1 : 0.5;
    file += "v " + std::to_string(radius * std::cos(angle)) + " " + std::to_string(radius * std::sin(angle)) + " 0\n";
    face.append(" ").append(std::to_string(i + 1));
  }
  return file + face + "\n";
}

std::string repeated(const std::string& text, int times) {
  std::string out;
  for (int i = 0; i < times; ++i) out += text;
  return out;
}

/// As `text`, each # replaced by a number that differs from line to line.
std::string numbered(const std::string& text, int times) {
  std::string out;
  for (int i = 0; i < times; ++i) {
    for (const char c : text) out += c == '#' ? std::to_string(i) : std::string(1, c);
  }
  return out;
}

void add_shapes(std::vector<HostileFile>& files) {
  const auto refuse = [&](const char* what, const std::string& bytes, const std::string& words) {
    files.push_back({.what = std::string("OBJ ") + what, .name = "a.obj", .bytes = bytes, .words = {words}});
  };
  const auto use = [&](const char* what, const std::string& bytes, const std::vector<std::string>& words = {}) {
    files.push_back({.what = std::string("OBJ ") + what, .name = "a.obj", .bytes = bytes, .usable = true, .words = words});
  };
  refuse("of a greeting", "hello\n", "no faces");
  refuse("of vertices only", "v 0 0 0\n", "no faces: none of its polygons has three or more corners (the file has 1 vertices)");
  refuse("of zeros", std::string(1'000, '\0'), "no faces");
  refuse("of edges", kThree + "f 1 2\nl 1 2 3\n", "no faces");
  refuse("of degenerate faces", kThree + repeated("f 1 1 2\nf 2 2 2\nf 1 2 1 2\n", 100), "the mesh has no face with an area");
  refuse("on a straight line", "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n", "the mesh has no face with an area");
  refuse("in a single point", repeated("v 7 7 7\n", 3) + "f 1 2 3\n", "the mesh has no face with an area");
  refuse("of the size of an atom", "v 0 0 0\nv 1e-300 0 0\nv 0 1e-300 0\nf 1 2 3\n", "the mesh has no face with an area");
  refuse("of the size of a universe", "v 0 0 0\nv 1e300 0 0\nv 0 1e300 0\nf 1 2 3\n", "the mesh");
  refuse("with an index of 0", kThree + "f 0 1 2\n", "line 4: vertex index 0 is out of range (OBJ counts from 1");
  refuse("with an index beyond the end", kThree + "f 1 2 99\nf 1 2 3\n",
         "line 4: vertex index 99 is out of range (the file has 3 vertices)");
  refuse("with an index before the beginning", kThree + "f 1 2 -4\n",
         "line 4: vertex index -4 is out of range (the file has 3 vertices)");
  refuse("with an index of 2^32", kThree + "f 1 2 4294967297\n", "line 4: vertex index 4294967297 is out of range");
  refuse("with an index of 2^63 - 1", kThree + "f 1 2 9223372036854775807\n", "line 4: vertex index 9223372036854775807 is out");
  refuse("with an index of -2^63", kThree + "f 1 2 -9223372036854775808\n", "line 4: vertex index -9223372036854775808 is out");
  refuse("with an index of a thousand digits", kThree + "f 1 2 " + std::string(1'000, '9') + "\n",
         "line 4: expected a vertex index, found '99999999999999999999999999999999...'");
  refuse("with a word as an index", kThree + "f 1 two 3\n", "line 4: expected a vertex index, found 'two'");
  refuse("with an odd index", kThree + "f 1 2 3/4/5/6\n", "line 4: expected a vertex index such as 7, 7/8, 7//9 or 7/8/9");
  refuse("with a NaN", "v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n", "line 2: a coordinate is not a finite number");
  refuse("with an infinity", "v 0 0 0\nv 1 0 0\nv 0 -inf 0\nf 1 2 3\n", "line 3: a coordinate is not a finite number");
  refuse("with 1e999", "v 0 0 0\nv 1e999 0 0\nv 0 1 0\nf 1 2 3\n", "line 2: a coordinate is not a finite number");
  refuse("with two coordinates", "v 0 0\n", "line 1: expected a coordinate of a vertex, but the line ends here");
  refuse("with a coordinate of two megabytes", "v " + std::string(2'000'000, '9') + " 0 0\n",
         "line 1: a coordinate is not a finite number");
  use("with a long fraction", "v 0." + std::string(5'000, '3') + " 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  use("with vertices of denormal numbers", "v 1e-310 -1e-320 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  use("with texture coordinates out of range", kThree + "vt 0 0\nf 1/9 2/-9 3/9223372036854775807\n",
      {"3 corners have texture coordinates that are not in the file (it has 1)"});
  use("with infinite texture coordinates", kThree + "vt nan inf\nvt 1e999 -1e999\nf 1/1 2/2 3/1\n");
  use("with a line of two megabytes", "# " + std::string(2'000'000, 'x') + "\n" + kTriangle);
  use("with a word of two megabytes", std::string(2'000'000, 'x') + "\n" + kTriangle);
  use("with a material's name of a megabyte", "usemtl " + std::string(1'000'000, 'm') + "\n" + kTriangle);
  use("with two megabytes of blanks", std::string(2'000'000, ' ') + "\n" + kTriangle);
  use("with two megabytes of backslashes", std::string(2'000'000, '\\') + "\n" + kTriangle);
  use("with a million continued lines", kThree + "f 1 2 " + repeated("\\\n", 500'000) + " 3\n");
  use("with mixed line ends", "v 0 0 0\rv 1 0 0\r\nv 0 1 0\n\rf 1 2 3");
  use("with a face of 60,000 corners, round and round", kThree + "f" + repeated(" 1 2 3", 20'000) + "\n");
  use("with a star of 20,000 corners", star(20'000));
  use(
      "with 20,000 faces at one edge", numbered("v 0.# 1 #\n", 20'000) + "v 0 0 0\nv 0 0 -1\n" + [] {
        std::string fans;
        for (int i = 1; i <= 20'000; ++i) fans += "f -1 -2 " + std::to_string(i) + "\n";
        return fans;
      }());
  use("with the same face 20,000 times", kThree + repeated("f 1 2 3\n", 20'000));
  use("with the same face in 20,000 groups", kThree + repeated("s 1\nf 1 2 3\n", 20'000));
  use("with 100,000 normals for one face", kThree + repeated("vn 0 0 1\n", 100'000) + "f 1//1 2//99999 3//100001\n");
  use("with normals that are none",
      kThree + "vn\nvn nan 0 1\nvn 1e400 1 0\nf 1//1 2//2 3//3\nf 3//-1 2//-9 1//99999999999999999999\n");
  use("with groups that are none", kThree + "s\ns off\ns -7\nf 1 2 3\ns 99999999999999999999\nf 3 2 1\n");
  use("with 30,000 materials", kThree + numbered("usemtl m#\nf 1 2 3\n", 30'000));
  const std::string whole = obj_file(pyramid());
  refuse("that ends within a vertex", whole.substr(0, whole.find("2.25")), "line 6: expected a coordinate of a vertex");
  refuse("in UTF-16", std::string("\xff\xfev\0 \0000\0 \0000\0 \0000\0\n\0", 18), "no faces");
}

void add_libraries(std::vector<HostileFile>& files) {
  const auto use = [&](const char* what, const std::string& library, const std::vector<std::string>& words = {}) {
    files.push_back({.what = std::string("MTL ") + what,
                     .name = "a.obj",
                     .bytes = "mtllib a.mtl\nusemtl m\n" + kTriangle,
                     .companions = {{"a.mtl", library}},
                     .usable = true,
                     .words = words});
  };
  const std::string not_there = "the material 'm' is in none of the material libraries";
  use("that is empty", "", {"line 2: " + not_there});
  use("of garbage", std::string("\x00\xff\x80\x01\n\x7f", 6), {not_there});
  use("without a material", "Kd 1 0 0\nmap_Kd a.png\n", {not_there});
  use("of other materials", "newmtl\nnewmtl \nnewmtl mm\n", {not_there});
  use("with a NaN", "newmtl m\nKd nan inf -inf\nd nan\nTr 1e999\n");
  use("with a Kd of thousands of digits", "newmtl m\nKd " + std::string(9'000, '9') + " 0." + std::string(9'000, '9') + " 1\n");
  use("with 100,000 materials", numbered("newmtl a#\n", 100'000) + "newmtl m\n");
  use("with the same material 100,000 times", repeated("newmtl m\n", 100'000));
  use("with a texture's name of a megabyte", "newmtl m\nmap_Kd " + std::string(1'000'000, 't') + "\n",
      {"line 2 of a.mtl", "is not a name of a file beside the mesh"});
  use("with options and no texture", "newmtl m\nmap_Kd -s 1 1 1 -o 0 0 0 -mm 0 1 -bm\n");
  use("with 100,000 options", "newmtl m\nmap_Kd " + repeated("-s 1 ", 100'000) + "t.png\n", {"the texture 't.png' is not there"});
  use("that ends within a word", "newmtl m\nmap_K");
  use("with a texture that is a library", "newmtl m\nmap_Kd a.mtl\n", {"the texture 'a.mtl' is neither PNG, JPEG nor WebP"});
  files.push_back({.what = "OBJ that is its own library",
                   .name = "a.obj",
                   .bytes = "mtllib a.obj\nusemtl m\n" + kTriangle,
                   .companions = {{"a.obj", "mtllib a.obj\nusemtl m\n" + kTriangle}},
                   .usable = true,
                   .words = {not_there}});
  files.push_back({.what = "OBJ that names a library 50,000 times",
                   .name = "a.obj",
                   .bytes = repeated("mtllib a.mtl\n", 50'000) + "usemtl m\n" + kTriangle,
                   .companions = {{"a.mtl", repeated("newmtl x\n", 10'000)}},
                   .usable = true,
                   .words = {not_there}});
  files.push_back({.what = "OBJ that names 50,000 libraries",
                   .name = "a.obj",
                   .bytes = numbered("mtllib a#.mtl\n", 50'000) + "usemtl m\n" + kTriangle,
                   .usable = true,
                   .words = {"line 1: the material library 'a0.mtl' is not there"}});
  files.push_back({.what = "OBJ with a line of 100,000 libraries",
                   .name = "a.obj",
                   .bytes = "mtllib" + numbered(" #.mtl", 100'000) + "\nusemtl m\n" + kTriangle,
                   .usable = true,
                   .words = {"line 1: the material library '0.mtl' is not there"}});
}

}  // namespace

std::vector<HostileFile> hostile_obj_files() {
  std::vector<HostileFile> files;
  add_shapes(files);
  add_libraries(files);
  return files;
}

}  // namespace curvecast::testing
