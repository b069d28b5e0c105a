// What a server tells of the files that it has, over TCP, and uploads whose size turns out at their end.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/server/eventually.h"
#include "tests/server/server_fixture.h"
#include "tests/server/two_callers.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

class ServerMeshes : public ServerFixture {
 protected:
  void SetUp() override { start({.http = "127.0.0.1:0"}); }
  ServerOptions known_callers() const {
    testing::write_file(folder_ / "tokens", kTokens);
    return {.tokens = folder_ / "tokens", .mesh_folder = folder_.path(), .cache = folder_ / "cache"};
  }

  static grpc::Status list(Stub& stub, const v1::ListMeshesRequest& request, v1::ListMeshesResponse* response) {
    grpc::ClientContext context;
    set_patience(context);
    return stub.ListMeshes(&context, request, response);
  }
  /// All that a caller is told of, on pages of that size.
  static std::vector<std::string> ids(Stub& stub, std::uint32_t page_size = 0) {
    std::vector<std::string> out;
    v1::ListMeshesRequest request;
    request.set_page_size(page_size);
    do {
      v1::ListMeshesResponse page;
      const grpc::Status status = list(stub, request, &page);
      EXPECT_TRUE(status.ok()) << status.error_message();
      EXPECT_LE(static_cast<std::uint32_t>(page.meshes_size()), page_size == 0 ? 100 : page_size);
      for (const v1::StoredMesh& mesh : page.meshes()) out.push_back(mesh.mesh_id());
      request.set_page_token(page.next_page_token());
    } while (!request.page_token().empty());
    return out;
  }
  static grpc::Status get(Stub& stub, const std::string& id) {
    grpc::ClientContext context;
    set_patience(context);
    v1::GetMeshRequest request;
    request.set_mesh_id(id);
    v1::GetMeshResponse response;
    return stub.GetMesh(&context, request, &response);
  }
  static std::string import(Stub& stub, const std::string& path) {
    grpc::ClientContext context;
    set_patience(context);
    v1::ImportMeshRequest request;
    request.set_path(path);
    v1::ImportMeshResponse response;
    const grpc::Status status = stub.ImportMesh(&context, request, &response);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return response.mesh_id();
  }

  testing::TemporaryFolder folder_;
};

TEST_F(ServerMeshes, AreListedInPages) {
  const auto stub = client();
  EXPECT_THAT(ids(*stub), IsEmpty());
  std::vector<std::string> sent;
  for (int i = 0; i < 105; ++i) sent.push_back(upload(*stub, "file " + std::to_string(i)));
  std::ranges::sort(sent);
  for (const std::uint32_t size : {0U, 1U, 10U, 105U, 1000U, ~0U}) {
    EXPECT_EQ(ids(*client(), size), sent) << size << "; without tokens everybody is one caller";
  }
  v1::ListMeshesResponse page;
  ASSERT_TRUE(list(*stub, {}, &page).ok());
  EXPECT_EQ(page.meshes_size(), 100);
  EXPECT_EQ(page.next_page_token(), page.meshes(99).mesh_id());
  EXPECT_EQ(page.meshes(0).name(), "test.off");
  EXPECT_GE(page.meshes(0).size(), 6u);
  for (const char* token : {"nonsense", "0123456789abcdef0123456789abcde", "../../etc/passwd"}) {
    v1::ListMeshesRequest request;
    request.set_page_token(token);
    EXPECT_EQ(list(*stub, request, &page).error_code(), grpc::INVALID_ARGUMENT) << token;
  }
}

TEST_F(ServerMeshes, OfOthersNobodyIsTold) {
  testing::write_file(folder_ / "imported.off", "OFF imported");
  start(known_callers());
  const auto anna = client_with("anna's"), bert = client_with("bert's");
  const std::string of_anna = upload(*anna, sphere_off(1)), imported = import(*anna, "imported.off");
  const std::string of_bert = upload(*bert, sphere_off(2));
  EXPECT_THAT(ids(*anna), UnorderedElementsAre(of_anna, imported));
  EXPECT_THAT(ids(*bert), ElementsAre(of_bert));
  EXPECT_EQ(ids(*anna, 1).size(), 2u);
  v1::ListMeshesResponse nothing;
  EXPECT_EQ(list(*client(), {}, &nothing).error_code(), grpc::UNAUTHENTICATED);
  EXPECT_EQ(nothing.meshes_size(), 0);
  // Who has the same file has its id, and is spared the upload.
  EXPECT_TRUE(get(*bert, of_anna).ok());
  EXPECT_THAT(ids(*bert), UnorderedElementsAre(of_anna, of_bert));
  EXPECT_THAT(ids(*anna), UnorderedElementsAre(of_anna, imported));
  EXPECT_EQ(upload(*anna, sphere_off(2)), of_bert);
  EXPECT_THAT(ids(*anna), UnorderedElementsAre(of_anna, of_bert, imported));
}

TEST_F(ServerMeshes, InTheCacheAreStillTheirOwners) {
  std::string of_anna, of_both;
  {
    start(known_callers());
    const auto anna = client_with("anna's"), bert = client_with("bert's");
    of_anna = upload(*anna, sphere_off(1));
    of_both = upload(*anna, sphere_off(2));
    EXPECT_EQ(upload(*bert, sphere_off(2)), of_both);
    EXPECT_THAT(ids(*bert), ElementsAre(of_both));
  }
  start(known_callers());  // again
  const auto anna = client_with("anna's"), bert = client_with("bert's");
  EXPECT_THAT(ids(*anna), ElementsAre(of_anna)) << "the other was sent last by bert";
  EXPECT_THAT(ids(*bert), ElementsAre(of_both));
  EXPECT_TRUE(get(*anna, of_both).ok());
  EXPECT_THAT(ids(*anna), UnorderedElementsAre(of_anna, of_both));
}

TEST_F(ServerMeshes, OfWhoIsApartAreHisAlone) {
  ServerOptions options = known_callers();
  options.isolate = true;
  start(options);
  const auto anna = client_with("anna's"), bert = client_with("bert's");
  const std::string id = upload(*anna, sphere_off(1));
  EXPECT_THAT(ids(*anna), ElementsAre(id));
  EXPECT_THAT(ids(*bert), IsEmpty());
  EXPECT_EQ(get(*bert, id).error_code(), grpc::NOT_FOUND);
  EXPECT_THAT(ids(*bert), IsEmpty()) << "to ask for it is not to have it";
  EXPECT_EQ(upload(*bert, sphere_off(1)), id);
  EXPECT_THAT(ids(*bert), ElementsAre(id));
  start(options);  // again
  EXPECT_THAT(ids(*client_with("anna's")), ElementsAre(id));
  EXPECT_THAT(ids(*client_with("bert's")), ElementsAre(id));
}

TEST_F(ServerMeshes, OfUnknownSizeAreTaken) {
  start({.max_upload_bytes = 100'000});
  const auto stub = client();
  v1::UploadHeader header;
  header.set_name("test.off");
  header.set_size_is_unknown(true);
  const std::string mesh = sphere_off(2);
  ASSERT_LT(mesh.size(), 100'000u);
  const Uploaded whole = upload(*stub, header, mesh);
  ASSERT_TRUE(whole.status.ok()) << whole.status.error_message();
  EXPECT_EQ(whole.response.size(), mesh.size());
  EXPECT_EQ(whole.response.mesh_id(), upload(*stub, mesh)) << "the same as with a size";
  header.set_mesh_id(whole.response.mesh_id());
  EXPECT_TRUE(upload(*stub, header, mesh).status.ok());
  EXPECT_EQ(upload(*stub, header, mesh + "\n").status.error_code(), grpc::INVALID_ARGUMENT) << "another hash";
  header.clear_mesh_id();
  EXPECT_TRUE(upload(*stub, header, std::string(100'000, 'x')).status.ok());
  const grpc::Status large = upload(*stub, header, std::string(100'001, 'x')).status;
  EXPECT_EQ(large.error_code(), grpc::RESOURCE_EXHAUSTED);
  EXPECT_THAT(large.error_message(), HasSubstr("100000"));
  EXPECT_EQ(upload(*stub, header, "").status.error_code(), grpc::INVALID_ARGUMENT);
  for (const bool has_size : {true, false}) {
    v1::UploadHeader both = header;
    has_size ? both.set_size(mesh.size()) : both.set_offset(1);
    const grpc::Status status = upload(*stub, both, mesh).status;
    EXPECT_EQ(status.error_code(), grpc::INVALID_ARGUMENT);
    EXPECT_THAT(status.error_message(), HasSubstr("size_is_unknown"));
  }
}

TEST_F(ServerMeshes, OfUnknownSizeThatBreakOffAreNone) {
  start({.max_uploads_of_client = 64, .http = "127.0.0.1:0"});  // cancelled ones take a moment to go
  const auto stub = client();
  v1::UploadMeshRequest header, chunk;
  header.mutable_header()->set_size_is_unknown(true);
  chunk.set_chunk(sphere_off(1));
  for (const bool cancels : {true, false}) {
    for (int i = 0; i < 20; ++i) {
      grpc::ClientContext context;
      set_patience(context);
      v1::UploadMeshResponse response;
      const auto writer = stub->UploadMesh(&context, &response);
      ASSERT_TRUE(writer->Write(header) && writer->Write(chunk));
      cancels ? context.TryCancel() : static_cast<void>(writer->WritesDone());
      EXPECT_EQ(writer->Finish().error_code(), cancels ? grpc::CANCELLED : grpc::INVALID_ARGUMENT);
    }
  }
  EXPECT_TRUE(eventually([&] { return metric("curvecast_mesh_bytes") == 0; }));
  EXPECT_THAT(ids(*stub), IsEmpty());
}

}  // namespace
}  // namespace curvecast::server
