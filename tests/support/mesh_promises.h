// What read_mesh, repair and the companions' names promise, for any bytes at all; asked by tests and by fuzzers.
#pragma once

#include <string>
#include <string_view>

#include "core/mesh/polygon_soup.h"
#include "core/mesh/repair.h"

namespace curvecast::testing {

/// The first promise of read_mesh that the soup breaks, in words; empty when it keeps all.
std::string broken_promise(const PolygonSoup& soup);

/// The same for repair.
std::string broken_promise(const RepairedMesh& repaired);

/// Whether a companion may be asked for by this name: joined to the mesh's folder it stays in there.
bool is_safe_name(std::string_view name);

}  // namespace curvecast::testing
