// The stages of preprocessing with their names, as the benchmarks list them.
#pragma once

#include <array>
#include <vector>

#include "core/pipeline/pipeline.h"

namespace curvecast::cli::bench {

struct Stage {
  const char* name;
  double StageSeconds::*seconds;
};

inline constexpr std::array<Stage, 8> kStages = {{{"read", &StageSeconds::read},
                                                  {"repair", &StageSeconds::repair},
                                                  {"cut", &StageSeconds::cut},
                                                  {"parameterise", &StageSeconds::parameterise},
                                                  {"curve", &StageSeconds::curve},
                                                  {"map", &StageSeconds::map},
                                                  {"area", &StageSeconds::area},
                                                  {"total", &StageSeconds::total}}};

/// Of each stage by itself; of an even number of runs the upper one. At least one run.
StageSeconds medians(const std::vector<StageSeconds>& runs);

}  // namespace curvecast::cli::bench
