#include "client/cli/bench/stages.h"

#include <algorithm>
#include <cstddef>

namespace curvecast::cli {

StageSeconds medians(const std::vector<StageSeconds>& runs) {
  StageSeconds result;
  for (const Stage& stage : kStages) {
    std::vector<double> values;
    for (const StageSeconds& run : runs) values.push_back(run.*stage.seconds);
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    result.*stage.seconds = *middle;
  }
  return result;
}

}  // namespace curvecast::cli
