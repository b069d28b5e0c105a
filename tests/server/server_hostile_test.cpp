// Hostile files over TCP: each is refused or becomes a session, and the server goes on serving.
#include <gtest/gtest.h>

#include <map>

#include "server_fixture.h"
#include "tests/support/hostile_files.h"

namespace curvecast::server {
namespace {

using curvecast::testing::HostileFile;

class ServerHostile : public ServerFixture {
 protected:
  Uploaded upload_as(Stub& stub, const std::string& name, const std::string& bytes) {
    v1::UploadHeader header;
    header.set_name(name);
    header.set_size(bytes.size());
    return upload(stub, header, bytes, 1'000'000);
  }

  /// The first thing that goes wrong on the way to a session.
  grpc::Status open(Stub& stub, const HostileFile& hostile) {
    const Uploaded mesh = upload_as(stub, hostile.name, hostile.bytes);
    if (!mesh.status.ok()) return mesh.status;
    std::map<std::string, std::string> companions;
    for (const auto& [name, bytes] : hostile.companions) {
      const Uploaded companion = upload_as(stub, name, bytes);
      if (companion.status.ok()) companions[name] = companion.response.mesh_id();
    }
    return create(stub, mesh.response.mesh_id(), 100, companions).status;
  }
};

TEST_F(ServerHostile, NoFileKeepsTheServerFromServing) {
  const std::unique_ptr<Stub> stub = client();
  for (const HostileFile& hostile : curvecast::testing::hostile_files()) {
    SCOPED_TRACE(hostile.what);
    const grpc::Status status = open(*stub, hostile);
    EXPECT_EQ(status.error_code(), hostile.usable ? grpc::OK : grpc::INVALID_ARGUMENT) << status.error_message();
  }
  const std::unique_ptr<Stub> other = client();
  const Created good = create(*other, upload(*other, sphere_off(3)), 1000);
  ASSERT_TRUE(good.status.ok()) << good.status.error_message();
  const Resampled points = resample(*other, good.session.session_id(), view_of(1000));
  EXPECT_TRUE(points.status.ok()) << points.status.error_message();
  EXPECT_EQ(points.points(), 1000u);
}

}  // namespace
}  // namespace curvecast::server
