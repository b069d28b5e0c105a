// What every store promises, whatever it is made of.
#pragma once

#include <string>
#include <vector>

#include "server/store/store.h"

namespace curvecast::server {

/// Puts, gets, replaces and removes files of these sizes (bytes), one at a time and by many threads, in a store that is empty,
/// and leaves it so.
void expect_store_contract(Store& store, const std::vector<std::size_t>& sizes);

}  // namespace curvecast::server
