// How far the making of a session is, all stages together.
#pragma once

#include <string_view>

namespace curvecast::server {

/// Returns the share, 0 to 1, of the time that a session takes which is over when a stage is done by `fraction`: as measured on
/// great meshes, whose users look at it longest. 0 for what is no stage of preprocessing.
double overall_progress(std::string_view stage, double fraction);

}  // namespace curvecast::server
