// What those fuzzers start from whose inputs are no mesh files.
#pragma once

#include <string>
#include <vector>

namespace curvecast::fuzzing {

struct Seed {
  std::string target, input;
};

/// Of the fuzzers 3mf (models alone), cache, formula, frame, preprocess, proxy, request, settings and websocket, which say
/// themselves what their inputs mean.
std::vector<Seed> seeds();

}  // namespace curvecast::fuzzing
