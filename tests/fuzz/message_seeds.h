// What the fuzzers of messages start from.
#pragma once

#include <vector>

#include "tests/fuzz/fuzz_seeds.h"

namespace curvecast::fuzzing {

/// For the fuzzer `request`: each request with all its fields, and a conversation. For `frame`: points as servers send them.
void add_messages(std::vector<Seed>& seeds);

}  // namespace curvecast::fuzzing
