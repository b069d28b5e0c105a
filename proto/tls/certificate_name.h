// SPDX-License-Identifier: Apache-2.0
// The name by which the holder of a certificate is known.
#pragma once

#include <string>

struct x509_st;  // OpenSSL's X509

namespace curvecast::tls {

/// The first URI among the certificate's alternative names, else its first DNS name, else its first address of mail, else the
/// subject's common name, else the whole subject ("O=Example,C=CH"). Empty where it has none of these.
std::string certificate_name(x509_st* certificate);
/// Of the first certificate of a PEM text; empty where there is none.
std::string certificate_name(const std::string& pem);

}  // namespace curvecast::tls
