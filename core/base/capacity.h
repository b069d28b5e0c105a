// Memory that vectors hold.
#pragma once

#include <cstddef>

namespace curvecast {

/// Returns the bytes that vectors have allocated, in use or not. Structures count theirs through a structured binding of all
/// their members, so that a member added to them does not compile before it is counted.
template <typename... Vectors>
std::size_t capacity_bytes(const Vectors&... vectors) {
  return (std::size_t{0} + ... + (vectors.capacity() * sizeof(typename Vectors::value_type)));
}

}  // namespace curvecast
