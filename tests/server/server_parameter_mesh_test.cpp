// GetParameterMesh, over TCP.
#include <gmock/gmock.h>

#include "server_fixture.h"
#include "tests/server/convert/values_of.h"

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;

class ServerParameterMesh : public ServerFixture {
 protected:
  struct Answer {
    grpc::Status status;
    std::vector<v1::GetParameterMeshResponse> responses;
  };
  static Answer get(Stub& stub, const std::string& mesh_id, v1::Parameteriser parameteriser, bool cancel_after_first = false) {
    grpc::ClientContext context;
    set_patience(context);
    v1::GetParameterMeshRequest request;
    request.set_mesh_id(mesh_id);
    request.set_parameteriser(parameteriser);
    const auto reader = stub.GetParameterMesh(&context, request);
    Answer answer;
    v1::GetParameterMeshResponse response;
    while (reader->Read(&response)) {
      answer.responses.push_back(response);
      if (cancel_after_first) context.TryCancel();
    }
    answer.status = reader->Finish();
    return answer;
  }
};

TEST_F(ServerParameterMesh, SendsTheWholeSurfaceInBoundedChunks) {
  const auto stub = client();
  const std::string id = upload(*stub, sphere_off(6));
  for (const v1::Parameteriser parameteriser : {v1::PARAMETERISER_UNSPECIFIED, v1::PARAMETERISER_CGAL}) {
    const Answer answer = get(*stub, id, parameteriser);
    ASSERT_TRUE(answer.status.ok()) << answer.status.error_message();
    ASSERT_GE(answer.responses.size(), 3u);  // there are more triangles than one chunk takes
    EXPECT_EQ(answer.responses[0].info().discs(), 1u);
    EXPECT_EQ(answer.responses[0].info().mesh().faces(), 32768u);
    EXPECT_GE(answer.responses[0].info().distortion().p50(), 1);
    std::string uv_bytes, triangle_bytes, ratio_bytes, cut_bytes;
    for (const auto& response : answer.responses) {
      EXPECT_LE(response.ByteSizeLong(), std::size_t{1} << 20);
      uv_bytes += response.chunk().uv();
      triangle_bytes += response.chunk().triangles();
      ratio_bytes += response.chunk().area_ratios();
      cut_bytes += response.chunk().border_cuts();
    }
    const auto uv = values_of<double>(uv_bytes), ratios = values_of<double>(ratio_bytes);
    const auto corners = values_of<std::uint32_t>(triangle_bytes);
    ASSERT_EQ(corners.size(), 3 * ratios.size());
    double area = 0;
    for (std::size_t t = 0; t < ratios.size(); ++t) {
      const auto at = [&](int i, int axis) { return uv.at(2 * corners[3 * t + i] + axis); };
      const double square = 0.5 * ((at(1, 0) - at(0, 0)) * (at(2, 1) - at(0, 1)) - (at(2, 0) - at(0, 0)) * (at(1, 1) - at(0, 1)));
      EXPECT_GT(square, 0);
      area += square * ratios[t];
    }
    EXPECT_NEAR(area, answer.responses[0].info().mesh().area(), 1e-9 * area);
    EXPECT_EQ(cut_bytes.find('\0'), std::string::npos);  // a closed surface has no border of its own
  }
}

TEST_F(ServerParameterMesh, EndsWhenTheClientCancels) {
  const auto stub = client();
  const std::string id = upload(*stub, sphere_off(6));
  EXPECT_EQ(get(*stub, id, v1::PARAMETERISER_OWN, true).status.error_code(), grpc::CANCELLED);
  EXPECT_TRUE(get(*stub, id, v1::PARAMETERISER_OWN).status.ok());
}

TEST_F(ServerParameterMesh, RefusesUnknownMeshesAndParameterisers) {
  const auto stub = client();
  EXPECT_EQ(get(*stub, std::string(32, '0'), v1::PARAMETERISER_OWN).status.error_code(), grpc::NOT_FOUND);
  const std::string id = upload(*stub, sphere_off(1));
  const grpc::Status unknown = get(*stub, id, static_cast<v1::Parameteriser>(9)).status;
  EXPECT_EQ(unknown.error_code(), grpc::INVALID_ARGUMENT);
  EXPECT_THAT(unknown.error_message(), HasSubstr("parameteriser has the unknown value 9"));
  const std::string broken = upload(*stub, "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n");
  EXPECT_EQ(get(*stub, broken, v1::PARAMETERISER_OWN).status.error_code(), grpc::INVALID_ARGUMENT);
}

}  // namespace
}  // namespace curvecast::server
