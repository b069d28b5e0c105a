// What the mesh has at the points, over TCP.
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "server_fixture.h"

#include "tests/server/convert/values_of.h"
#include "tests/server/eventually.h"
#include "tests/support/analytic_directions.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::server {
namespace {

double heat_at(const Vec3d& p) { return 2 * p.x() - p.y() + 3 * p.z(); }

/// A torus, which is as hot as heat_at() says, and of which nobody knows the age where x is above 1.2.
std::string torus_ply() {
  PolygonSoup soup = testing::torus(80, 40);
  ScalarAttribute heat{"heat", {}}, age{"age", {}};
  for (const Vec3d& p : soup.positions) {
    heat.values.push_back(static_cast<float>(heat_at(p)));
    age.values.push_back(p.x() > 1.2 ? std::numeric_limits<float>::quiet_NaN() : 5);
  }
  soup.attributes.scalars = {heat, age};
  return testing::to_ply(soup);
}

class ServerAttributes : public ServerFixture {
 protected:
  static v1::SampleRequest request(std::uint64_t points, v1::Sampler sampler) {
    v1::SampleRequest sample;
    sample.set_points(points);
    sample.set_sampler(sampler);
    sample.mutable_encoding()->mutable_raw();
    sample.add_attributes(v1::POINT_ATTRIBUTE_DIRECTIONS);
    sample.add_attributes(v1::POINT_ATTRIBUTE_SCALARS);
    return sample;
  }

  static std::string make_session(Stub& stub, const std::string& mesh) {
    const Created created = create(stub, upload(stub, mesh), 2000);
    EXPECT_TRUE(created.status.ok()) << created.status.error_message();
    return created.session.session_id();
  }
};

TEST_F(ServerAttributes, DirectionsAndNamedValuesAreThoseOfTheSurface) {
  const auto stub = client();
  const std::string id = make_session(*stub, torus_ply());
  for (const v1::Sampler sampler : {v1::SAMPLER_EQUALISED, v1::SAMPLER_PROGRESSIVE}) {
    for (const std::uint64_t n : {1000u, 30'000u}) {  // at the curve's vertices, and many in each of its leaves
      const Resampled resampled = resample(*stub, id, request(n, sampler));
      ASSERT_TRUE(resampled.status.ok()) << resampled.status.error_message();
      std::size_t unknown = 0;
      for (const v1::ResampleResponse& response : resampled.blocks) {
        const v1::PointBlock& block = response.points();
        const std::size_t count = block.count();
        const auto positions = values_of<std::array<float, 3>>(block.raw().positions());
        const auto normals = values_of<std::array<float, 3>>(block.raw().normals());
        const auto directions = values_of<std::array<float, 3>>(block.attributes().directions());
        ASSERT_EQ(directions.size(), count);
        ASSERT_EQ(block.attributes().scalars_size(), 2);
        EXPECT_EQ(block.attributes().scalars(0).name(), "heat");
        EXPECT_EQ(block.attributes().scalars(1).name(), "age");
        const auto heat = values_of<float>(block.attributes().scalars(0).values());
        const auto age = values_of<float>(block.attributes().scalars(1).values());
        ASSERT_EQ(heat.size(), count);
        ASSERT_EQ(age.size(), count);
        for (std::size_t i = 0; i < count; ++i) {
          const Vec3d p(positions[i][0], positions[i][1], positions[i][2]);
          const Vec3d normal(normals[i][0], normals[i][1], normals[i][2]);
          const Vec3d least(directions[i][0], directions[i][1], directions[i][2]);
          ASSERT_NEAR(heat[i], heat_at(p), 1e-4);
          ASSERT_TRUE(p.x() > 1.1 || std::abs(age[i] - 5) < 1e-5);
          unknown += std::isnan(age[i]) ? 1 : 0;
          ASSERT_NEAR(least.norm(), 1, 1e-5);
          ASSERT_NEAR(least.dot(normal), 0, 1e-4);
          ASSERT_LT(testing::axis_angle(normal.cross(least), *testing::around_the_tube(p)), 0.1);
        }
      }
      EXPECT_GT(unknown, n / 200);
    }
  }
}

TEST_F(ServerAttributes, MeshesWithoutNamedValuesHaveNone) {
  const auto stub = client();
  const std::string id = make_session(*stub, sphere_off(3));
  const Resampled resampled = resample(*stub, id, request(100, v1::SAMPLER_EQUALISED));
  ASSERT_TRUE(resampled.status.ok()) << resampled.status.error_message();
  EXPECT_EQ(resampled.blocks[0].points().attributes().scalars_size(), 0);
  EXPECT_EQ(resampled.blocks[0].points().attributes().directions().size(), 1200u);
}

TEST_F(ServerAttributes, CountWithinABudgetOfBytes) {
  const auto stub = client();
  const std::string id = make_session(*stub, torus_ply());
  v1::SampleRequest sample = request(1, v1::SAMPLER_PROGRESSIVE);
  sample.set_max_bytes(100'000);
  const Resampled resampled = resample(*stub, id, sample);
  ASSERT_TRUE(resampled.status.ok()) << resampled.status.error_message();
  EXPECT_EQ(resampled.points(), 100'000u / (28 + 12 + 8));
}

TEST_F(ServerAttributes, AreTheSameFromASurfaceInTheCache) {
  const testing::TemporaryFolder folder;
  start({.max_curve_vertices = 1, .cache = folder.path()});
  std::string id, before[2];
  {
    const auto stub = client();
    id = make_session(*stub, torus_ply());
    EXPECT_TRUE(eventually([&] {
      grpc::ClientContext context;
      set_patience(context);
      v1::GetSessionRequest wanted;
      wanted.set_session_id(id);
      v1::GetSessionResponse found;
      return stub->GetSession(&context, wanted, &found).ok() && found.session().cached();
    }));
    before[0] = resample(*stub, id, request(3000, v1::SAMPLER_EQUALISED)).bytes();
    before[1] = resample(*stub, id, request(3000, v1::SAMPLER_PROGRESSIVE)).bytes();
  }
  start({.max_curve_vertices = 1, .cache = folder.path()});
  const auto stub = client();
  for (const int i : {0, 1}) {
    const Resampled again = resample(*stub, id, request(3000, i == 0 ? v1::SAMPLER_EQUALISED : v1::SAMPLER_PROGRESSIVE));
    ASSERT_TRUE(again.status.ok()) << again.status.error_message();
    EXPECT_EQ(again.bytes(), before[i]);
  }
}

}  // namespace
}  // namespace curvecast::server
