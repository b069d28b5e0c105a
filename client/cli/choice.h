// Names that a flag may take.
#pragma once

#include "proto/terms/choice.h"

namespace curvecast::cli {

using terms::check_choice;

}  // namespace curvecast::cli
