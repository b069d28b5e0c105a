#include "tests/fuzz/fuzz_seeds.h"

#include <cstdint>

namespace curvecast::fuzzing {
namespace {

std::string little_endian(std::uint64_t number, int bytes) {
  std::string out;
  for (int i = 0; i < bytes; ++i) out += static_cast<char>(number >> 8 * i & 0xff);
  return out;
}

void add_formula(std::vector<Seed>& seeds) {
  std::string power = "x";
  while (power.size() < 990) power += "^x";
  for (const std::string& text :
       {std::string("1"), std::string("(x > 0) * (1 + abs(mean))"), std::string("nx + ny * nz / gauss"), std::string("k2 - k1"),
        std::string("heat > 0.5 ? sin(x) : cos(y)"), std::string("min(x, y, z) ^ max(1, 2)"),
        std::string("x == y && z != 1 || !x"), std::string("sqrt(-1)"), std::string("1 / 0"), std::string("x = 2"),
        std::string("1, 2"), std::string("nothing + 1"), std::string("rint(atan2(x, 1e300)) + _pi - _e"),
        std::string(400, '(') + "x" + std::string(400, ')'), std::string(500, '-') + "x", power, std::string(1001, '1'),
        std::string("sum(") + std::string(300, '1') + ")"}) {
    seeds.push_back({"formula", '\x10' + text});
    seeds.push_back({"formula", '\x01' + text});
  }
}

void add_preprocess(std::vector<Seed>& seeds) {
  const auto add = [&](const std::string& ways, std::uint8_t ending, std::uint8_t where, const std::string& places,
                       const std::string& corners) {
    // 50 points, omega 3.
    seeds.push_back({"preprocess", little_endian(50, 2) + '\x02' + ways + little_endian(ending, 1) + little_endian(where, 1) +
                                       little_endian(places.size() / 3 - 3, 1) + places + corners});
  };
  constexpr char kLow = '\x68', kMiddle = '\x78', kHigh = '\x88';  // -1, 0 and 1
  std::string cube;
  for (int v = 0; v < 8; ++v) {
    for (int i = 0; i < 3; ++i) cube += (v >> i & 1) != 0 ? kHigh : kLow;
  }
  std::string cube_faces;
  for (const int v :
       {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5}) {
    cube_faces += static_cast<char>(v);
  }
  std::string grid, grid_faces;
  for (int v = 0; v < 25; ++v) grid += {static_cast<char>(kLow + 8 * (v % 5)), static_cast<char>(kLow + 8 * (v / 5)), kMiddle};
  for (int v = 0; v < 19; ++v) {
    if (v % 5 == 4) continue;
    for (const int corner : {v, v + 1, v + 5, v + 1, v + 6, v + 5}) grid_faces += static_cast<char>(corner);
  }
  for (const std::string& ways : {std::string("\xff\0", 2), std::string("\x41\x01", 2), std::string("\x01\x02", 2),
                                  std::string("\x00\x03", 2), std::string("\xf0\x00", 2)}) {
    for (const std::uint8_t ending : {0, 2, 3, 11, 43}) {
      for (const std::uint8_t where : {0x00, 0x04, 0x07, 0x38}) {
        add(ways, ending, where, cube, cube_faces);
        add(ways, ending, where, grid, grid_faces);
        add(ways, ending, where, cube, cube_faces.substr(0, 30) + cube_faces);
        add(ways, ending, where, cube.substr(0, 12), std::string("\0\1\2", 3));
      }
    }
  }
}

}  // namespace

std::vector<Seed> seeds() {
  std::vector<Seed> seeds;
  add_formula(seeds);
  add_preprocess(seeds);
  return seeds;
}

}  // namespace curvecast::fuzzing
