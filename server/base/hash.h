// The content hash that names meshes and sessions: XXH3-128.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

struct XXH3_state_s;

namespace curvecast::server {

/// Hashes bytes that come piece by piece. Not thread-safe.
class Hasher {
 public:
  Hasher();
  void update(std::string_view bytes);
  /// Hash of all bytes so far: 32 hexadecimal digits, lower case, as `xxh128sum` prints it.
  std::string hex() const;

 private:
  struct Free {
    void operator()(XXH3_state_s* state) const;
  };
  std::unique_ptr<XXH3_state_s, Free> state_;
};

/// Hashes bytes, and returns the hash as numbers.
std::array<std::uint64_t, 2> hash_of(std::string_view bytes);

}  // namespace curvecast::server
