// SPDX-License-Identifier: Apache-2.0
#include "proto/tls/pem_files.h"

#include <absl/strings/str_cat.h>
#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/x509.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <memory>

namespace curvecast::tls {
namespace {

constexpr std::streamsize kMaxBytes = 1 << 20;

struct Free {
  void operator()(BIO* bio) const { BIO_free(bio); }
  void operator()(X509* certificate) const { X509_free(certificate); }
  void operator()(EVP_PKEY* key) const { EVP_PKEY_free(key); }
};
using Certificate = std::unique_ptr<X509, Free>;
using Key = std::unique_ptr<EVP_PKEY, Free>;

absl::StatusOr<std::string> read(const std::string& path) {
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    const std::string message = absl::StrCat(path, ": cannot be opened: ", std::strerror(errno));
    return errno == ENOENT ? absl::NotFoundError(message) : absl::InvalidArgumentError(message);
  }
  std::string bytes(kMaxBytes + 1, '\0');
  file.read(bytes.data(), kMaxBytes + 1);
  if (file.bad()) return absl::InvalidArgumentError(absl::StrCat(path, ": cannot be read"));
  if (file.gcount() > kMaxBytes) return absl::InvalidArgumentError(absl::StrCat(path, ": is too large for a certificate or key"));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  return bytes;
}

std::unique_ptr<BIO, Free> over(const std::string& bytes) {
  return std::unique_ptr<BIO, Free>(BIO_new_mem_buf(bytes.data(), static_cast<int>(bytes.size())));
}

/// Never asks the terminal; notes that somebody wanted a password.
int refuse_password(char* /*buffer*/, int /*size*/, int /*writes*/, void* wanted) {
  *static_cast<bool*>(wanted) = true;
  return -1;
}

/// Looks at all of them.
absl::StatusOr<Certificate> first_certificate(const std::string& bytes, const std::string& path) {
  bool wants_password = false;
  const std::unique_ptr<BIO, Free> bio = over(bytes);
  const auto next = [&] { return Certificate(PEM_read_bio_X509(bio.get(), nullptr, refuse_password, &wants_password)); };
  Certificate first = next();
  if (first != nullptr) {
    while (next() != nullptr) {
    }
  }
  const bool is_end = ERR_GET_REASON(ERR_peek_last_error()) == PEM_R_NO_START_LINE;
  ERR_clear_error();
  if (first == nullptr) return absl::InvalidArgumentError(absl::StrCat(path, ": there is no certificate in it (PEM)"));
  if (!is_end) return absl::InvalidArgumentError(absl::StrCat(path, ": a certificate in it is malformed"));
  return first;
}

absl::StatusOr<Key> private_key(const std::string& bytes, const std::string& path) {
  bool wants_password = false;
  Key key(PEM_read_bio_PrivateKey(over(bytes).get(), nullptr, refuse_password, &wants_password));
  ERR_clear_error();
  if (key != nullptr) return key;
  return absl::InvalidArgumentError(absl::StrCat(
      path, wants_password ? ": the key is encrypted; give one without a password" : ": there is no private key in it (PEM)"));
}

}  // namespace

absl::StatusOr<Identity> read_identity(const std::string& certificate_path, const std::string& key_path) {
  absl::StatusOr<std::string> certificates = read(certificate_path);
  if (!certificates.ok()) return certificates.status();
  absl::StatusOr<std::string> key_bytes = read(key_path);
  if (!key_bytes.ok()) return key_bytes.status();
  const absl::StatusOr<Certificate> certificate = first_certificate(*certificates, certificate_path);
  if (!certificate.ok()) return certificate.status();
  const absl::StatusOr<Key> key = private_key(*key_bytes, key_path);
  if (!key.ok()) return key.status();
  const bool belongs = X509_check_private_key(certificate->get(), key->get()) == 1;
  ERR_clear_error();
  if (!belongs) {
    return absl::InvalidArgumentError(
        absl::StrCat(key_path, ": the key does not belong to the certificate in ", certificate_path));
  }
  return Identity{*std::move(certificates), *std::move(key_bytes)};
}

absl::StatusOr<std::string> read_authorities(const std::string& path) {
  absl::StatusOr<std::string> bytes = read(path);
  if (!bytes.ok()) return bytes.status();
  if (const auto certificate = first_certificate(*bytes, path); !certificate.ok()) return certificate.status();
  return bytes;
}

}  // namespace curvecast::tls
