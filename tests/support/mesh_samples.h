// Small good files of every format that is read, with all that they can hold: what tests cut and damage, and fuzzers start from.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace curvecast::testing {

struct MeshSample {
  std::string name;  // its ending tells the format
  std::string bytes;
  std::map<std::string, std::string, std::less<>> companions = {};
};

std::vector<MeshSample> mesh_samples();

}  // namespace curvecast::testing
