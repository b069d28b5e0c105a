#include "tests/support/real_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace curvecast::testing {
namespace {

struct Known {
  const char *name, *stand_in;
};

constexpr std::array<Known, 13> kKnown = {{
    {"3holes.off", "double-torus-3-holes.off"},
    {"camelhead.off", "camel.off"},
    {"chinese-lion.obj", "ChineseDragon-10kv.off"},
    {"fertility.off", "holes.off"},
    {"igea-tristrips.ply", "armadillo.off"},
    {"igea.ply", "bunny00.off"},
    {"lionstatue.obj", "lion.off"},
    {"rocker-arm.obj", "handle.off"},
    {"skull.obj", "refined_elephant.off"},
    {"spot.obj", "cow.off"},
    {"squirrel.obj", "bear.off"},
    {"stanford-bunny.obj", "elephant-with-holes.off"},
    {"teapot.obj", "blobby_3cc.off"},
}};

std::filesystem::path folder() {
  const char* const meshes = std::getenv("CURVECAST_MESHES");
  return meshes != nullptr ? meshes : CURVECAST_SOURCE_DIR "/../shared/meshes";
}

}  // namespace

RealMesh real_mesh(std::string_view name) {
  const auto known = std::find_if(kKnown.begin(), kKnown.end(), [&](const Known& k) { return k.name == name; });
  if (known == kKnown.end()) {
    ADD_FAILURE() << "no real mesh is called " << name;
    return {};
  }
  std::filesystem::path path = folder() / name;
  if (!std::filesystem::exists(path)) path = std::filesystem::path(CURVECAST_LIBRARY_MESHES) / known->stand_in;
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    ADD_FAILURE() << path << " is not there; deploy/setup installs the package libcgal-demo that brings it";
    return {};
  }
  return {path.filename(), std::string(std::istreambuf_iterator<char>(file), {})};
}

std::vector<const char*> real_mesh_names() {
  std::vector<const char*> names;
  for (const Known& known : kKnown) names.push_back(known.name);
  return names;
}

}  // namespace curvecast::testing
