// Meshes with files that they refer to, over TCP.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdint>
#include <map>

#include "core/render/png_file.h"
#include "server_fixture.h"

namespace curvecast::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using Companions = std::map<std::string, std::string>;

constexpr char kSquare[] =
    "mtllib square.mtl\nusemtl picture\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    "f 1/1 2/2 3/3 4/4\n";
constexpr char kLibrary[] = "newmtl picture\nKd 1 1 1\nmap_Kd textures/left_right.png\n";

/// Red on the left, blue on the right.
std::string picture() {
  constexpr int kSide = 32;
  Image image{kSide, kSide, {}};
  for (int i = 0; i < kSide * kSide; ++i) {
    const bool left = i % kSide < kSide / 2;
    for (const int value : {left ? 255 : 0, 0, left ? 0 : 255, 255}) image.rgba.push_back(static_cast<std::uint8_t>(value));
  }
  return encode_png(image).value_or("");
}

class ServerCompanions : public ServerFixture {
 protected:
  void SetUp() override {
    ServerFixture::SetUp();
    stub_ = client();
    mesh_id_ = upload_as("square.obj", kSquare);
  }

  std::string upload_as(const std::string& name, const std::string& bytes) {
    v1::UploadHeader header;
    header.set_name(name);
    header.set_size(bytes.size());
    const Uploaded uploaded = upload(*stub_, header, bytes);
    EXPECT_TRUE(uploaded.status.ok()) << uploaded.status.error_message();
    return uploaded.response.mesh_id();
  }
  Companions all_companions() {
    return {{"square.mtl", upload_as("square.mtl", kLibrary)},
            {"textures/left_right.png", upload_as("left_right.png", picture())}};
  }

  std::vector<std::string> missing(const Companions& companions) {
    grpc::ClientContext context;
    set_patience(context);
    v1::ListMeshReferencesRequest request;
    v1::ListMeshReferencesResponse response;
    request.set_mesh_id(mesh_id_);
    request.mutable_companions()->insert(companions.begin(), companions.end());
    const grpc::Status status = stub_->ListMeshReferences(&context, request, &response);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return {response.missing().begin(), response.missing().end()};
  }

  grpc::Status inspect(const Companions& companions, v1::MeshInfo* info) {
    grpc::ClientContext context;
    set_patience(context);
    v1::InspectMeshRequest request;
    v1::InspectMeshResponse response;
    request.set_mesh_id(mesh_id_);
    request.mutable_companions()->insert(companions.begin(), companions.end());
    const grpc::Status status = stub_->InspectMesh(&context, request, &response);
    *info = response.mesh();
    return status;
  }

  std::unique_ptr<Stub> stub_;
  std::string mesh_id_;
};

TEST_F(ServerCompanions, NamesWhatIsMissing) {
  EXPECT_THAT(missing({}), ElementsAre("square.mtl"));
  const Companions all = all_companions();
  EXPECT_THAT(missing({*all.find("square.mtl")}), ElementsAre("textures/left_right.png"));
  EXPECT_THAT(missing(all), IsEmpty());
}

TEST_F(ServerCompanions, ATextureColoursThePoints) {
  const Companions companions = all_companions();
  const Created created = create(*stub_, mesh_id_, 2000, companions);
  ASSERT_TRUE(created.status.ok()) << created.status.error_message();
  EXPECT_THAT(created.session.report().mesh().warnings(), IsEmpty());
  v1::SampleRequest sample;
  sample.set_points(2000);
  sample.mutable_encoding()->mutable_raw();
  const Resampled resampled = resample(*stub_, created.session.session_id(), sample);
  ASSERT_TRUE(resampled.status.ok()) << resampled.status.error_message();
  ASSERT_EQ(resampled.blocks.size(), 1u);
  const v1::RawPoints& raw = resampled.blocks[0].points().raw();
  ASSERT_EQ(raw.colours().size(), 6000u);
  for (std::size_t i = 0; i < 2000; ++i) {
    const auto x = reinterpret_cast<const float*>(raw.positions().data())[3 * i];
    if (std::abs(x - 0.5) < 0.1 || x < 0.1 || x > 0.9) continue;  // where both colours meet
    const auto* colour = reinterpret_cast<const std::uint8_t*>(raw.colours().data()) + 3 * i;
    EXPECT_EQ(colour[0], x < 0.5 ? 255 : 0) << x;
    EXPECT_EQ(colour[1], 0) << x;
    EXPECT_EQ(colour[2], x < 0.5 ? 0 : 255) << x;
  }

  const Created plain = create(*stub_, mesh_id_, 2000);
  ASSERT_TRUE(plain.status.ok()) << plain.status.error_message();
  EXPECT_NE(plain.session.session_id(), created.session.session_id());
  EXPECT_EQ(create(*stub_, mesh_id_, 2000, companions).session.session_id(), created.session.session_id());
  const Resampled uncoloured = resample(*stub_, plain.session.session_id(), sample);
  ASSERT_TRUE(uncoloured.status.ok());
  EXPECT_EQ(uncoloured.blocks[0].points().raw().positions(), raw.positions()) << "colours move nothing";
  EXPECT_TRUE(uncoloured.blocks[0].points().raw().colours().empty());
}

TEST_F(ServerCompanions, InspectionTellsOfThem) {
  v1::MeshInfo info;
  ASSERT_TRUE(inspect({}, &info).ok());
  EXPECT_THAT(info.warnings(), ::testing::Contains(HasSubstr("square.mtl")));
  ASSERT_TRUE(inspect(all_companions(), &info).ok());
  EXPECT_THAT(info.warnings(), IsEmpty());
  EXPECT_THAT(info.attributes(), ::testing::Contains("textures"));
}

TEST_F(ServerCompanions, RefusesWhatItDoesNotHold) {
  v1::MeshInfo info;
  const grpc::Status unknown = inspect({{"square.mtl", "00112233445566778899aabbccddeeff"}}, &info);
  EXPECT_EQ(unknown.error_code(), grpc::NOT_FOUND);
  EXPECT_THAT(unknown.error_message(), HasSubstr("companion \"square.mtl\""));
  Companions many;
  for (int i = 0; i < 257; ++i) many[std::to_string(i)] = mesh_id_;
  EXPECT_EQ(inspect(many, &info).error_code(), grpc::INVALID_ARGUMENT);
  EXPECT_EQ(inspect({{std::string(2000, 'x'), mesh_id_}}, &info).error_code(), grpc::INVALID_ARGUMENT);
  EXPECT_EQ(create(*stub_, mesh_id_, 100, {{"square.mtl", "x"}}).status.error_code(), grpc::NOT_FOUND);
  mesh_id_ = "00112233445566778899aabbccddeeff";
  EXPECT_EQ(inspect({}, &info).error_code(), grpc::NOT_FOUND);
}

}  // namespace
}  // namespace curvecast::server
