#include "server/base/hash.h"

#include <absl/strings/escaping.h>
#include <openssl/evp.h>
#include <openssl/sha.h>

#include <cstring>
#include <new>

namespace curvecast::server {
namespace {

constexpr std::size_t kBytes = 16;  // of the digest that are taken

/// Nothing of OpenSSL's that is called here fails but for lack of memory.
void check(int result) {
  if (result != 1) throw std::bad_alloc();
}

}  // namespace

void Hasher::Free::operator()(evp_md_ctx_st* context) const { EVP_MD_CTX_free(context); }

Hasher::Hasher() : context_(EVP_MD_CTX_new()) {
  check(context_ != nullptr);
  check(EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr));
}

void Hasher::update(std::string_view bytes) { check(EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size())); }

std::array<unsigned char, SHA256_DIGEST_LENGTH> Hasher::digest() const {
  const Hasher copy;  // the end of a digest takes no more bytes
  check(EVP_MD_CTX_copy_ex(copy.context_.get(), context_.get()));
  std::array<unsigned char, SHA256_DIGEST_LENGTH> digest;
  check(EVP_DigestFinal_ex(copy.context_.get(), digest.data(), nullptr));
  return digest;
}

std::string Hasher::sha256() const {
  const auto all = digest();
  return absl::BytesToHexString({reinterpret_cast<const char*>(all.data()), all.size()});
}

std::string Hasher::hex() const { return sha256().substr(0, 2 * kBytes); }

std::string sha256(std::string_view bytes) {
  std::array<unsigned char, SHA256_DIGEST_LENGTH> digest;
  SHA256(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(), digest.data());
  return {reinterpret_cast<const char*>(digest.data()), digest.size()};
}

std::array<std::uint64_t, 2> hash_of(std::string_view bytes) {
  const std::string digest = sha256(bytes);
  std::array<std::uint64_t, 2> hash;
  static_assert(sizeof hash == kBytes);
  std::memcpy(hash.data(), digest.data(), kBytes);
  return hash;
}

}  // namespace curvecast::server
