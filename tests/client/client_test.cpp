#include "client/lib/client.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "client/lib/file_bytes.h"
#include "tests/client/fake_connection.h"
#include "tests/client/sphere_points.h"

namespace curvecast::client {
namespace {

using ::testing::_;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::NiceMock;
using ::testing::Pair;
using ::testing::Return;

class ClientTest : public ::testing::Test {
 protected:
  std::shared_ptr<NiceMock<FakeConnection>> connection_ = std::make_shared<NiceMock<FakeConnection>>();
  Client client_{connection_};
};

/// Takes an upload as a server does, and answers with the hash of what has come.
auto receive(std::string* received) {
  return [received](const v1::UploadHeader& header, const ReadAt& read, const OnBytes& on_bytes,
                    std::stop_token) -> absl::StatusOr<v1::UploadMeshResponse> {
    received->resize(header.size());
    for (std::size_t offset = 0; offset < received->size(); ++offset) {
      if (absl::Status status = read(offset, {received->data() + offset, 1}); !status.ok()) return status;
    }
    on_bytes(header.size());
    v1::UploadMeshResponse response;
    response.set_mesh_id(mesh_id_of(*received));
    response.set_size(received->size());
    return response;
  };
}

TEST_F(ClientTest, MeshIdsAreSha256) {
  // As `sha256sum` begins for no input at all, and for `printf abc`.
  EXPECT_EQ(mesh_id_of({}), "e3b0c44298fc1c149afbf4c8996fb924");
  EXPECT_EQ(mesh_id_of(std::string("abc")), "ba7816bf8f01cfea414140de5dae2223");
}

TEST_F(ClientTest, FilesAreHashedWhole) {
  const std::string path = ::testing::TempDir() + "/curvecast_client_hash_test", bytes(3'000'000, 'h');
  ASSERT_TRUE(write_bytes(path, bytes).ok());
  const auto file = InputFile::open(path);
  ASSERT_TRUE(file.ok()) << file.status();
  const auto sha256 = sha256_of(*file);
  ASSERT_TRUE(sha256.ok()) << sha256.status();
  EXPECT_EQ(sha256->size(), 64U);
  EXPECT_EQ(mesh_id_of_sha256(*sha256), mesh_id_of(bytes));
  std::stop_source stop;
  stop.request_stop();
  EXPECT_TRUE(absl::IsCancelled(sha256_of(*file, stop.get_token()).status()));
}

TEST_F(ClientTest, UploadsOnlyWhatIsNotThereYet) {
  EXPECT_CALL(*connection_, get_mesh).WillOnce(Return(v1::GetMeshResponse()));
  EXPECT_CALL(*connection_, upload_mesh).Times(0);
  const std::string bytes = "OFF";
  EXPECT_EQ(*client_.upload_mesh("x.off", std::span<const char>(bytes)), mesh_id_of(bytes));
}

TEST_F(ClientTest, UploadsAFileUnderItsNameAndHash) {
  const std::string path = ::testing::TempDir() + "/curvecast_client_test.off";
  const std::string bytes(100, 'm');
  ASSERT_TRUE(write_bytes(path, bytes).ok());
  std::string received;
  ON_CALL(*connection_, get_mesh).WillByDefault(Return(absl::NotFoundError("no")));
  EXPECT_CALL(*connection_, upload_mesh)
      .WillOnce([&](const v1::UploadHeader& header, const ReadAt& read, const OnBytes& on_bytes, std::stop_token stop) {
        EXPECT_EQ(header.name(), "curvecast_client_test.off");
        EXPECT_EQ(header.mesh_id(), mesh_id_of(bytes));
        return receive(&received)(header, read, on_bytes, stop);
      });
  double fraction = 0;
  const auto mesh_id = client_.upload_mesh(path, [&](std::string_view stage, double f) {
    EXPECT_EQ(stage, "upload");
    fraction = f;
  });
  ASSERT_TRUE(mesh_id.ok()) << mesh_id.status();
  EXPECT_EQ(*mesh_id, mesh_id_of(bytes));
  EXPECT_EQ(received, bytes);
  EXPECT_EQ(fraction, 1);
}

/// A server that takes everything, and for each list of references names the next of `rounds`, the last one for ever.
class ReferenceTest : public ClientTest {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) / ("curvecast_references_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_ / "mesh");
    for (const char* name : {"mesh/a.obj", "mesh/a.off", "mesh/a.mtl", "mesh/t.png", "secret.png"}) {
      ASSERT_TRUE(write_bytes((folder_ / name).string(), std::string("content of ") + name).ok());
    }
    ON_CALL(*connection_, get_mesh).WillByDefault(Return(absl::NotFoundError("no")));
    ON_CALL(*connection_, upload_mesh)
        .WillByDefault([this](const v1::UploadHeader& header, const ReadAt& read, const OnBytes& on_bytes, std::stop_token stop) {
          std::string received;
          auto response = receive(&received)(header, read, on_bytes, stop);
          uploads_.push_back(received);
          return response;
        });
    ON_CALL(*connection_, list_mesh_references)
        .WillByDefault([this](const v1::ListMeshReferencesRequest& request, std::stop_token) {
          requests_.push_back(request);
          v1::ListMeshReferencesResponse response;
          for (const std::string& name : rounds_[std::min(requests_.size(), rounds_.size()) - 1]) response.add_missing(name);
          return response;
        });
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  absl::StatusOr<UploadedMesh> upload(const char* name) {
    return client_.upload_with_companions((folder_ / "mesh" / name).string());
  }

  std::filesystem::path folder_;
  std::vector<std::vector<std::string>> rounds_ = {{}};
  std::vector<std::string> uploads_;
  std::vector<v1::ListMeshReferencesRequest> requests_;
};

TEST_F(ReferenceTest, FollowsReferencesToReferences) {
  rounds_ = {{"a.mtl", "missing.mtl"}, {"missing.mtl", "t.png"}, {"missing.mtl"}};
  const auto mesh = upload("a.obj");
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_THAT(uploads_, ElementsAre("content of mesh/a.obj", "content of mesh/a.mtl", "content of mesh/t.png"));
  EXPECT_EQ(mesh->mesh_id, mesh_id_of(std::string("content of mesh/a.obj")));
  EXPECT_THAT(mesh->companions, ElementsAre(Pair("a.mtl", mesh_id_of(std::string("content of mesh/a.mtl"))),
                                            Pair("t.png", mesh_id_of(std::string("content of mesh/t.png")))));
  EXPECT_THAT(mesh->missing, ElementsAre("missing.mtl"));
  ASSERT_EQ(requests_.size(), 3U);
  EXPECT_EQ(requests_[2].companions().size(), 2U);

  EXPECT_CALL(*connection_, inspect_mesh).WillOnce([&](const v1::InspectMeshRequest& request, std::stop_token) {
    EXPECT_EQ(request.companions().size(), 2U);
    return v1::InspectMeshResponse();
  });
  EXPECT_TRUE(client_.inspect(*mesh).ok());
  EXPECT_CALL(*connection_, create_session)
      .WillOnce([&](const v1::CreateSessionRequest& request, const OnProgress&, std::stop_token) {
        EXPECT_EQ(request.companions().at("t.png"), mesh_id_of(std::string("content of mesh/t.png")));
        return v1::Session();
      });
  EXPECT_TRUE(client_.create_session(*mesh, {}).ok());
}

TEST_F(ReferenceTest, SendsNothingFromElsewhereWhateverTheServerAsksFor) {
  rounds_ = {{"../secret.png", (folder_ / "secret.png").string(), "a.off", "/etc/passwd", "", "..", "../mesh/t.png"}};
  const auto mesh = upload("a.obj");
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_THAT(uploads_, ElementsAre("content of mesh/a.obj"));
  EXPECT_TRUE(mesh->companions.empty());
  EXPECT_EQ(mesh->missing, rounds_[0]);
  ASSERT_EQ(mesh->refused.size(), 7U);
  EXPECT_THAT(mesh->refused[0], HasSubstr("../secret.png"));
  EXPECT_CALL(*connection_, inspect_mesh).WillOnce(Return(v1::InspectMeshResponse()));
  EXPECT_EQ(client_.inspect(*mesh)->warnings_size(), 7) << "the user learns why";
}

TEST_F(ReferenceTest, AsksOnlyForFormatsThatRefer) {
  EXPECT_CALL(*connection_, list_mesh_references).Times(0);
  EXPECT_TRUE(upload("a.off").ok());
}

TEST_F(ReferenceTest, AServerThatNeverEndsIsLeft) {
  rounds_.clear();
  for (int round = 0; round < 50; ++round) {
    const std::string name = std::to_string(round) + ".png";
    ASSERT_TRUE(write_bytes((folder_ / "mesh" / name).string(), name).ok());
    rounds_.push_back({name});
  }
  ASSERT_TRUE(upload("a.obj").ok());
  EXPECT_EQ(requests_.size(), 8U);
  requests_.clear();
  rounds_ = {{}};
  for (int i = 0; i < 1000; ++i) rounds_[0].push_back("../" + std::to_string(i));
  rounds_[0].push_back("t.png");
  const auto mesh = upload("a.obj");
  ASSERT_TRUE(mesh.ok());
  EXPECT_TRUE(mesh->companions.empty()) << "after 256 names";
}

TEST_F(ReferenceTest, PassesErrorsOn) {
  ON_CALL(*connection_, list_mesh_references).WillByDefault(Return(absl::InvalidArgumentError("broken")));
  EXPECT_TRUE(absl::IsInvalidArgument(upload("a.obj").status()));
}

TEST_F(ClientTest, SendsPointsThatAreToBeMeasuredOnce) {
  Points points;
  points.origin = {1, 2, 3};
  points.positions = {{1, 0, 0}, {0, 1, 0.5}};
  std::string received;
  EXPECT_CALL(*connection_, get_mesh)
      .WillOnce(Return(absl::NotFoundError("no such mesh")))
      .WillRepeatedly(Return(v1::GetMeshResponse()));
  EXPECT_CALL(*connection_, upload_mesh).WillOnce(receive(&received));
  v1::MeasureRequest sent;
  v1::Measures answer;
  answer.add_sets();
  answer.add_sets();
  EXPECT_CALL(*connection_, measure).WillRepeatedly([&](const v1::MeasureRequest& request, const OnProgress& on_progress, auto) {
    sent = request;
    v1::Progress progress;
    progress.set_stage("rings");
    on_progress(progress);
    return answer;
  });
  std::vector<std::string> stages;
  const StageProgress on_progress = [&](std::string_view stage, double) { stages.emplace_back(stage); };
  v1::MeasureRequest request;
  request.set_seed(7);
  const std::vector<Points> sets = {points, points};
  ASSERT_TRUE(client_.measure(UploadedMesh("m"), sets, request, on_progress).ok());
  EXPECT_THAT(stages, ElementsAre("upload", "rings"));
  ASSERT_EQ(received.size(), 24u);
  EXPECT_EQ(std::memcmp(received.data(), points.positions.data(), 24), 0);
  EXPECT_EQ(sent.mesh_id(), "m");
  EXPECT_EQ(sent.seed(), 7u);
  ASSERT_EQ(sent.sets_size(), 2);
  EXPECT_EQ(sent.sets(1).points_id(), mesh_id_of(received));
  EXPECT_EQ(sent.sets(1).origin().z(), 3);
  answer.clear_sets();
  EXPECT_TRUE(absl::IsDataLoss(client_.measure(UploadedMesh("m"), sets, request, on_progress).status()));
}

TEST_F(ClientTest, SaysWhichFileCannotBeRead) {
  EXPECT_CALL(*connection_, get_mesh).Times(0);
  const absl::Status status = client_.upload_mesh("/nonexistent/mesh.ply").status();
  EXPECT_TRUE(absl::IsNotFound(status));
  EXPECT_THAT(std::string(status.message()), HasSubstr("/nonexistent/mesh.ply"));
}

TEST_F(ClientTest, NoticesAMeshThatArrivedChanged) {
  ON_CALL(*connection_, get_mesh).WillByDefault(Return(absl::NotFoundError("no")));
  ON_CALL(*connection_, upload_mesh).WillByDefault(Return(v1::UploadMeshResponse()));
  EXPECT_TRUE(absl::IsDataLoss(client_.upload_mesh("x.off", std::span<const char>("OFF", 3)).status()));
}

TEST_F(ClientTest, PassesOtherErrorsOn) {
  ON_CALL(*connection_, get_mesh).WillByDefault(Return(absl::UnavailableError("gone")));
  EXPECT_CALL(*connection_, upload_mesh).Times(0);
  EXPECT_TRUE(absl::IsUnavailable(client_.upload_mesh("x.off", std::span<const char>("OFF", 3)).status()));
  ON_CALL(*connection_, resample).WillByDefault(Return(absl::OutOfRangeError("too many")));
  EXPECT_TRUE(absl::IsOutOfRange(client_.resample({}).status()));
}

TEST_F(ClientTest, JoinsBlocksInOrder) {
  const Points points = sphere_points(10);
  std::vector<v1::ResampleResponse> responses;
  for (std::size_t begin = 0; begin < 10; begin += 5) {
    Points half;
    half.positions.assign(points.positions.begin() + begin, points.positions.begin() + begin + 5);
    half.normals.assign(points.normals.begin() + begin, points.normals.begin() + begin + 5);
    half.radii.assign(points.radii.begin() + begin, points.radii.begin() + begin + 5);
    *responses.emplace_back().mutable_points() = raw_block(half);
  }
  responses.back().mutable_statistics()->set_curve_vertices(77);
  ON_CALL(*connection_, resample).WillByDefault(Return(responses));
  v1::ResampleRequest request;
  request.mutable_sample()->set_points(10);
  const auto sample = client_.resample(request);
  ASSERT_TRUE(sample.ok()) << sample.status();
  EXPECT_EQ(sample->points.positions, points.positions);
  EXPECT_EQ(sample->points.normals, points.normals);
  EXPECT_EQ(sample->points.radii, points.radii);
  EXPECT_EQ(sample->statistics.curve_vertices(), 77U);
  EXPECT_EQ(sample->bytes, 280U);

  responses.back().mutable_points()->mutable_raw()->set_colours(std::string(15, 'c'));
  ON_CALL(*connection_, resample).WillByDefault(Return(responses));
  EXPECT_TRUE(absl::IsDataLoss(client_.resample(request).status())) << "colours for all points or for none";

  request.mutable_sample()->set_points(11);
  EXPECT_TRUE(absl::IsDataLoss(client_.resample(request).status())) << "exactly as many as asked for";

  responses.back().mutable_points()->mutable_raw()->clear_colours();
  ON_CALL(*connection_, resample).WillByDefault(Return(responses));
  EXPECT_TRUE(absl::IsDataLoss(client_.resample(request).status()));
  request.mutable_sample()->set_sampler(v1::SAMPLER_PROGRESSIVE);
  EXPECT_TRUE(client_.resample(request).ok()) << "fewer, where there are no more candidates";
  request.mutable_sample()->clear_sampler();
  request.mutable_sample()->add_density()->mutable_distance()->set_global(true);
  EXPECT_TRUE(client_.resample(request).ok()) << "fewer, from afar";
  request.mutable_sample()->set_points(9);
  EXPECT_TRUE(absl::IsDataLoss(client_.resample(request).status())) << "but not more";
  request.mutable_sample()->set_max_bytes(5000);
  EXPECT_TRUE(client_.resample(request).ok()) << "as many as a budget holds";
  ON_CALL(*connection_, resample).WillByDefault(Return(std::vector<v1::ResampleResponse>{}));
  EXPECT_TRUE(absl::IsDataLoss(client_.resample(request).status())) << "but not none";
}

TEST_F(ClientTest, ScattersPoints) {
  const Points points = sphere_points(10);
  std::vector<v1::ScatterResponse> responses(2);
  responses[0].mutable_mesh()->set_faces(80);
  *responses[1].mutable_points()->mutable_points() = raw_block(points);
  responses[1].mutable_points()->mutable_statistics()->set_equalise_seconds(3);
  v1::ScatterRequest sent;
  EXPECT_CALL(*connection_, scatter).WillRepeatedly([&](const v1::ScatterRequest& request, auto&&...) {
    sent = request;
    return responses;
  });
  UploadedMesh mesh("m");
  mesh.companions["wood.png"] = "w";
  mesh.refused = {"it lies elsewhere"};
  v1::ScatterRequest request;
  request.mutable_sample()->set_points(10);
  const auto scattered = client_.scatter(mesh, request);
  ASSERT_TRUE(scattered.ok()) << scattered.status();
  EXPECT_EQ(sent.mesh_id(), "m");
  EXPECT_EQ(sent.companions().at("wood.png"), "w");
  EXPECT_EQ(scattered->sample.points.positions, points.positions);
  EXPECT_EQ(scattered->sample.statistics.equalise_seconds(), 3);
  EXPECT_EQ(scattered->mesh.faces(), 80U);
  EXPECT_EQ(scattered->mesh.warnings(0), "it lies elsewhere.");
  for (const std::uint64_t other : {9u, 11u}) {
    request.mutable_sample()->set_points(other);
    EXPECT_TRUE(absl::IsDataLoss(client_.scatter(mesh, request).status())) << "exactly as many as asked for";
  }
  responses.pop_back();
  EXPECT_TRUE(absl::IsDataLoss(client_.scatter(mesh, request).status()));
}

TEST_F(ClientTest, ForwardsSessions) {
  v1::Session session;
  session.set_session_id("s");
  EXPECT_CALL(*connection_, create_session)
      .WillOnce([&](const v1::CreateSessionRequest& request, const OnProgress& on_progress, std::stop_token) {
        EXPECT_EQ(request.mesh_id(), "m");
        EXPECT_EQ(request.options().max_points(), 5U);
        v1::Progress progress;
        progress.set_stage("map");
        progress.set_fraction(0.5);
        on_progress(progress);
        return session;
      });
  v1::SessionOptions options;
  options.set_max_points(5);
  std::string seen;
  const auto created = client_.create_session(std::string("m"), options, [&](std::string_view stage, double) { seen = stage; });
  ASSERT_TRUE(created.ok()) << created.status();
  EXPECT_EQ(created->session_id(), "s");
  EXPECT_EQ(seen, "map");

  v1::ListSessionsResponse list;
  *list.add_sessions() = session;
  ON_CALL(*connection_, list_sessions).WillByDefault(Return(list));
  EXPECT_EQ(client_.list_sessions()->size(), 1U);
  v1::ListSessionsResponse more = list;
  more.set_next_page_token("s");
  ON_CALL(*connection_, list_sessions).WillByDefault([&](const v1::ListSessionsRequest& request, std::stop_token) {
    return request.page_token().empty() ? more : list;
  });
  EXPECT_EQ(client_.list_sessions()->size(), 2U) << "all pages";
  ON_CALL(*connection_, list_sessions).WillByDefault(Return(more));
  EXPECT_TRUE(absl::IsDataLoss(client_.list_sessions().status())) << "the same page for ever";
  ON_CALL(*connection_, close_session).WillByDefault(Return(absl::NotFoundError("unknown")));
  EXPECT_TRUE(absl::IsNotFound(client_.close_session("t")));
}

TEST_F(ClientTest, MeshesComeInPages) {
  v1::ListMeshesResponse first, last;
  first.add_meshes()->set_mesh_id("a");
  first.set_next_page_token("a");
  last.add_meshes()->set_mesh_id("b");
  last.mutable_meshes(0)->set_name("b.ply");
  last.mutable_meshes(0)->set_size(12);
  ON_CALL(*connection_, list_meshes).WillByDefault([&](const v1::ListMeshesRequest& request, std::stop_token) {
    return request.page_token().empty() ? first : last;
  });
  const auto listed = client_.list_meshes();
  ASSERT_TRUE(listed.ok()) << listed.status();
  ASSERT_EQ(listed->size(), 2U);
  EXPECT_EQ(listed->at(0).mesh_id(), "a");
  EXPECT_EQ(listed->at(1).name(), "b.ply");
  EXPECT_EQ(listed->at(1).size(), 12U);
  ON_CALL(*connection_, list_meshes).WillByDefault(Return(first));
  EXPECT_TRUE(absl::IsDataLoss(client_.list_meshes().status())) << "the same page for ever";
  ON_CALL(*connection_, list_meshes).WillByDefault(Return(absl::UnimplementedError("an older server")));
  EXPECT_TRUE(absl::IsUnimplemented(client_.list_meshes().status()));
}

}  // namespace
}  // namespace curvecast::client
