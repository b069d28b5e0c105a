#include "client/cli/bench/stages.h"

#include <utility>

#include "client/cli/bench/median.h"

namespace curvecast::cli {

StageSeconds medians(const std::vector<StageSeconds>& runs) {
  StageSeconds result;
  for (const Stage& stage : kStages) {
    std::vector<double> values;
    for (const StageSeconds& run : runs) values.push_back(run.*stage.seconds);
    result.*stage.seconds = median(std::move(values));
  }
  return result;
}

}  // namespace curvecast::cli
