#include "client/bench/paper/ways.h"

namespace curvecast::cli::bench {

PreprocessOptions preprocess_options(Way way, std::uint64_t points) {
  PreprocessOptions options{.points = points};
  if (way == kDefaults) return options;
  options.parameteriser = Parameteriser::kCgal;
  options.mapper = Mapper::kIdBuffer;
  options.area_element = AreaElement::kVoronoi;
  return options;
}

SessionFlags session_flags(Way way) {
  SessionFlags flags;
  if (way == kDefaults) return flags;
  flags.parameteriser = "cgal";
  flags.mapper = "id-buffer";
  flags.area = "voronoi";
  return flags;
}

}  // namespace curvecast::cli::bench
