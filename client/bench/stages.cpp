#include "client/bench/stages.h"

#include <utility>

#include "client/bench/median.h"

namespace curvecast::cli::bench {

StageSeconds medians(const std::vector<StageSeconds>& runs) {
  StageSeconds result;
  for (const Stage& stage : kStages) {
    std::vector<double> values;
    for (const StageSeconds& run : runs) values.push_back(run.*stage.seconds);
    result.*stage.seconds = median(std::move(values));
  }
  return result;
}

}  // namespace curvecast::cli::bench
