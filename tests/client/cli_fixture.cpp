#include "tests/client/cli_fixture.h"

#include <unistd.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>

namespace curvecast::cli {

std::string folder() { return ::testing::TempDir() + "/curvecast_cli_test_" + std::to_string(getpid()); }

std::string temporary(const std::string& name) { return folder() + "/" + name; }

std::string write_sphere(const std::string& name, int rings) {
  const int columns = 2 * rings;
  std::ostringstream vertices, faces;
  int face_count = 0;
  const auto index = [&](int ring, int column) { return 1 + (ring - 1) * columns + column % columns; };
  const int last = 1 + (rings - 1) * columns;
  vertices << "0 0 1\n";
  for (int ring = 1; ring < rings; ++ring) {
    const double theta = std::numbers::pi * ring / rings;
    for (int column = 0; column < columns; ++column) {
      const double phi = 2 * std::numbers::pi * column / columns;
      vertices << std::sin(theta) * std::cos(phi) << ' ' << std::sin(theta) * std::sin(phi) << ' ' << std::cos(theta) << '\n';
    }
  }
  vertices << "0 0 -1\n";
  for (int column = 0; column < columns; ++column) {
    faces << "3 0 " << index(1, column) << ' ' << index(1, column + 1) << '\n';
    faces << "3 " << last << ' ' << index(rings - 1, column + 1) << ' ' << index(rings - 1, column) << '\n';
    face_count += 2;
    for (int ring = 1; ring + 1 < rings; ++ring) {
      faces << "4 " << index(ring, column) << ' ' << index(ring + 1, column) << ' ' << index(ring + 1, column + 1) << ' '
            << index(ring, column + 1) << '\n';
      ++face_count;
    }
  }
  const std::string path = temporary(name);
  std::ofstream(path) << "OFF\n" << last + 1 << ' ' << face_count << " 0\n" << vertices.str() << faces.str();
  return path;
}

}  // namespace curvecast::cli
