// Points straight on a mesh, without a session, over HTTP.
#include <absl/strings/str_cat.h>
#include <gmock/gmock.h>

#include <cstring>

#include "tests/server/web/resources/resources_fixture.h"

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class ScatteredPointsResource : public ResourcesFixture {
 protected:
  /// The points of a mesh of which there is no session.
  Response points(const std::string& mesh, const std::string& rest, const HeaderFields& fields = {}) const {
    return get(absl::StrCat("/v1/meshes/", mesh, "/points.", rest), fields);
  }
};

TEST_F(ScatteredPointsResource, AreThoseOfTheApi) {
  const std::string mesh = put_sphere();
  v1::ScatterRequest request;
  request.set_mesh_id(mesh);
  request.mutable_sample()->set_points(500);
  request.mutable_sample()->set_seed(7);
  request.mutable_sample()->set_relaxation_rounds(2);
  request.mutable_sample()->mutable_encoding()->mutable_raw();
  grpc::ClientContext context;
  set_patience(context);
  const auto stub = client();
  const auto reader = stub->Scatter(&context, request);
  std::string positions;
  for (v1::ScatterResponse response; reader->Read(&response);) positions += response.points().points().raw().positions();
  ASSERT_TRUE(reader->Finish().ok());
  const auto found = json_of(points(mesh, "json?n=500&seed=7&relax=2"));
  EXPECT_EQ(found["count"], 500);
  ASSERT_EQ(found["positions"].size() * sizeof(float), positions.size());
  for (std::size_t i = 0; i < found["positions"].size(); ++i) {
    float value = 0;
    std::memcpy(&value, positions.data() + i * sizeof value, sizeof value);
    ASSERT_EQ(found["positions"][i].get<float>(), value) << i;
  }
  EXPECT_EQ(json_of(get("/v1/sessions"))["sessions"].size(), 0u) << "nothing was prepared";
  EXPECT_EQ(json_of(points(mesh, "json"))["count"], 65'536) << "as many as a session is made for";
}

TEST_F(ScatteredPointsResource, ComeInManyKindsOfFiles) {
  const std::string mesh = put_sphere();
  const auto body_of = [&](const std::string& file) {
    const Response response = points(mesh, file);
    EXPECT_EQ(response.status, 200) << file << ": " << response.body.substr(0, 300);
    return response.body;
  };
  EXPECT_THAT(body_of("ply?n=30000&attributes=surface,curvatures"), HasSubstr("element vertex 30000\n"));
  EXPECT_THAT(body_of("npz?n=300"), StartsWith("PK"));
  EXPECT_THAT(body_of("glb?n=300&splats=true"), HasSubstr("KHR_gaussian_splatting"));
  EXPECT_THAT(body_of("spz?n=300"), StartsWith("\x1f\x8b"));
  EXPECT_THAT(body_of("las?n=300"), StartsWith("LASF"));
  EXPECT_THAT(body_of("drc?n=300&position_bits=14"), StartsWith("DRACO"));
  EXPECT_EQ(field_of(points(mesh, "ply?n=10"), "Content-Disposition"), "attachment; filename=\"sphere.ply\"");
}

TEST_F(ScatteredPointsResource, FollowCamerasAndDensities) {
  const std::string mesh = put_sphere();
  const auto least_z = [&](const std::string& query) {
    const auto found = json_of(points(mesh, "json?n=400&" + query));
    double least = 1e9;
    for (std::size_t i = 2; i < found["positions"].size(); i += 3) {
      least = std::min(least, found["positions"][i].get<double>() + found["origin"][2].get<double>());
    }
    return least;
  };
  EXPECT_LT(least_z(""), -0.9);
  EXPECT_GT(least_z("density=expression:z%20%3E%200"), -0.2);
  EXPECT_GT(least_z("density=view:s0=0&camera=eye=0,0,1000"), -0.2) << "nothing on the far side";
}

TEST_F(ScatteredPointsResource, TakeWhatTheMeshRefersTo) {
  const Response material = ask("PUT", "/v1/meshes/wood.mtl?inspect=false", "newmtl red\nKd 1 0 0\n");
  ASSERT_EQ(material.status, 201) << material.body;
  const std::string square = "mtllib wood.mtl\nusemtl red\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
  const std::string mesh = json_of(ask("PUT", "/v1/meshes/square.obj", square))["meshId"];
  EXPECT_FALSE(json_of(points(mesh, "json?n=20")).contains("colours"));
  const std::string with = absl::StrCat("json?n=20&companion=", json_of(material)["meshId"].get<std::string>(), ":wood.mtl");
  const auto red = json_of(points(mesh, with));
  ASSERT_TRUE(red.contains("colours")) << red.dump().substr(0, 300);
  EXPECT_EQ(red["colours"][0], 255);
  EXPECT_EQ(red["colours"][1], 0);
}

TEST_F(ScatteredPointsResource, ThatAClientHasAreNotSentAgain) {
  const std::string mesh = put_sphere();
  const Response first = points(mesh, "ply?n=400");
  const std::string tag = field_of(first, "ETag");
  ASSERT_THAT(tag, ::testing::MatchesRegex("\"[0-9a-f]{32}\""));
  HttpClient client(server_->http_port());
  client.send(request_text("GET", "/v1/meshes/" + mesh + "/points.ply?n=400", {}, {{"If-None-Match", tag}}));
  EXPECT_EQ(client.receive(false).status, 304);
  EXPECT_EQ(points(mesh, "ply?n=400&seed=1", {{"If-None-Match", tag}}).status, 200);
  EXPECT_EQ(points(mesh, "ply?n=400").body, first.body);
}

TEST_F(ScatteredPointsResource, ErrorsSayWhatIsWrong) {
  const std::string mesh = put_sphere();
  const auto error = [&](const std::string& id, const std::string& rest, int status) {
    const Response response = points(id, rest);
    EXPECT_EQ(response.status, status) << rest << ": " << response.body;
    return json_of(response)["message"].get<std::string>();
  };
  error(std::string(32, '0'), "ply?n=10", 404);
  EXPECT_THAT(error(mesh, "doc", 404), HasSubstr("there are: ply, npz"));
  EXPECT_THAT(error(mesh, "ply?n=0", 400), HasSubstr("points"));
  EXPECT_THAT(error(mesh, "ply?pixel_error=2", 400), HasSubstr("by their number"));
  EXPECT_THAT(error(mesh, "ply?n=10&sampler=progressive", 400), HasSubstr("fixed ranks"));
  EXPECT_THAT(error(mesh, "ply?n=10&companion=wood.mtl", 400), HasSubstr("ID:NAME"));
  EXPECT_THAT(error(mesh, "ply?n=10&companion=0:wood.mtl", 404), HasSubstr("wood.mtl"));
  EXPECT_THAT(error(mesh, "ply?n=10&crease=sharp", 400), HasSubstr("degrees"));
  EXPECT_THAT(error(mesh, "ply?n=10&crease=200", 400), HasSubstr("crease_degrees"));
  EXPECT_THAT(error(mesh, "ply?n=10&density=attribute:weight", 400), HasSubstr("weight"));
  EXPECT_EQ(ask("POST", "/v1/meshes/" + mesh + "/points.ply").status, 405);
  EXPECT_EQ(get("/v1/meshes/" + mesh + "/picture.png").status, 404);
}

}  // namespace
}  // namespace curvecast::server
