// The content hash that names meshes and sessions: the first half of SHA-256. Whoever could forge it would give his mesh to
// others.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

struct evp_md_ctx_st;

namespace curvecast::server {

/// Hashes bytes that come piece by piece. Not thread-safe.
class Hasher {
 public:
  Hasher();
  void update(std::string_view bytes);
  /// Hash of all bytes so far: 32 hexadecimal digits, lower case, the first half of what `sha256sum` prints.
  std::string hex() const;
  /// All 64 digits of it.
  std::string sha256() const;

 private:
  std::array<unsigned char, 32> digest() const;
  struct Free {
    void operator()(evp_md_ctx_st* context) const;
  };
  std::unique_ptr<evp_md_ctx_st, Free> context_;
};

/// SHA-256 of bytes: 32 of them.
std::string sha256(std::string_view bytes);
/// Hashes bytes as Hasher::hex(), and returns the hash as numbers.
std::array<std::uint64_t, 2> hash_of(std::string_view bytes);

}  // namespace curvecast::server
