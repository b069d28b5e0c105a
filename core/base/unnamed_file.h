// A file without a name: gone as soon as nobody holds it, however the process ends.
#pragma once

#include <string>

namespace curvecast {

/// Returns the descriptor of an empty file in `folder`, to read and write; -1 and errno where that takes none.
int open_unnamed_file(const std::string& folder);

}  // namespace curvecast
