#include "tests/proto/tls/certificate_files.h"

#include <cstdlib>

namespace curvecast::testing {
namespace {

void run(const std::string& command) { EXPECT_EQ(std::system((command + " 2> /dev/null").c_str()), 0) << command; }

}  // namespace

CertificateFiles::CertificateFiles() {
  const std::string curve = " -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes ";
  for (const std::string authority : {"ca", "other"}) {
    run("openssl req -x509 -days 2 -subj /CN=" + authority + curve + "-keyout " + key(authority) + " -out " + cert(authority));
    for (const std::string role : {"server", "client"}) {
      const std::string name = authority + "-" + role, request = folder_ / "request.pem";
      const std::string names = write("names", "subjectAltName=DNS:localhost,IP:127.0.0.1\n");
      run("openssl req -subj /CN=" + role + curve + "-keyout " + key(name) + " -out " + request);
      run("openssl x509 -req -days 2 -in " + request + " -CA " + cert(authority) + " -CAkey " + key(authority) +
          " -CAcreateserial -extfile " + names + " -out " + cert(name));
    }
  }
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
