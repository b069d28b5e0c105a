#include "tests/proto/tls/certificate_files.h"

#include <cstdlib>

namespace curvecast::testing {
namespace {

void run(const std::string& command) { EXPECT_EQ(std::system((command + " 2> /dev/null").c_str()), 0) << command; }

constexpr char kCurve[] = " -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes ";

}  // namespace

CertificateFiles::CertificateFiles() {
  for (const std::string authority : {"ca", "other"}) {
    run("openssl req -x509 -days 2 -subj /CN=" + authority + kCurve + "-keyout " + key(authority) + " -out " + cert(authority));
    for (const std::string role : {"server", "client"}) {
      issue(authority, authority + "-" + role, "/CN=" + role, "DNS:localhost,IP:127.0.0.1");
    }
  }
}

void CertificateFiles::issue(const std::string& authority, const std::string& name, const std::string& subject,
                             const std::string& alternatives) const {
  const std::string request = folder_ / "request.pem";
  const std::string names = write("names", alternatives.empty() ? "" : "subjectAltName=" + alternatives + "\n");
  run("openssl req -subj '" + subject + "'" + kCurve + "-keyout " + key(name) + " -out " + request);
  run("openssl x509 -req -days 2 -in " + request + " -CA " + cert(authority) + " -CAkey " + key(authority) +
      " -CAcreateserial -extfile " + names + " -out " + cert(name));
}

std::string CertificateFiles::write(const std::string& name, const std::string& text) const {
  write_file(folder_ / name, text);
  return folder_ / name;
}

std::string CertificateFiles::encrypted_key(const std::string& name) const {
  const std::string path = folder_ / "encrypted.key";
  run("openssl pkey -aes256 -passout pass:secret -in " + key(name) + " -out " + path);
  return path;
}

}  // namespace curvecast::testing
