// FindNeighbours, over TCP.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "server_fixture.h"

#include "tests/server/convert/values_of.h"
#include "tests/support/shapes.h"

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;

using Point = std::array<float, 3>;

class ServerNeighbours : public ServerFixture {
 protected:
  struct Answer {
    grpc::Status status;
    std::string positions, counts, indices, distances, last;  // `last`: kind of message
    std::set<std::string> stages;
    std::size_t largest = 0, statistics = 0;  // bytes of a message; messages
    bool is_in_order = true;                  // points before neighbours
  };

  /// All others of a point, nearest first.
  struct Other {
    std::uint32_t index;
    float square;
  };

  static v1::FindNeighboursRequest request(const std::string& session_id, std::uint64_t points) {
    v1::FindNeighboursRequest request;
    request.set_session_id(session_id);
    request.mutable_sample()->set_points(points);
    request.mutable_sample()->mutable_encoding()->mutable_raw();
    return request;
  }

  static Answer ask(Stub& stub, const v1::FindNeighboursRequest& request, bool cancel_after_first = false) {
    grpc::ClientContext context;
    set_patience(context);
    const auto reader = stub.FindNeighbours(&context, request);
    Answer answer;
    for (v1::FindNeighboursResponse response; reader->Read(&response);) {
      if (response.has_progress()) {
        answer.stages.insert(response.progress().stage());
        continue;
      }
      answer.largest = std::max(answer.largest, response.neighbours().ByteSizeLong());
      if (response.has_points() && !answer.counts.empty()) answer.is_in_order = false;
      answer.statistics += response.points().has_statistics() ? 1 : 0;
      answer.positions += response.points().points().raw().positions();
      answer.counts += response.neighbours().counts();
      answer.indices += response.neighbours().indices();
      answer.distances += response.neighbours().distances();
      if (cancel_after_first) context.TryCancel();
    }
    answer.status = reader->Finish();
    return answer;
  }

  std::string make_session(Stub& stub, const std::string& mesh) {
    const Created created = create(stub, upload(stub, mesh), 4000);
    EXPECT_TRUE(created.status.ok()) << created.status.error_message();
    return created.session.session_id();
  }

  /// Checks an answer against all pairs of its points. `scale`: of the mesh.
  static void expect_nearest(const Answer& answer, std::size_t n, std::size_t count, double scale = 1) {
    ASSERT_TRUE(answer.status.ok()) << answer.status.error_message();
    const auto positions = values_of<Point>(answer.positions);
    const auto counts = values_of<std::uint32_t>(answer.counts), indices = values_of<std::uint32_t>(answer.indices);
    const auto distances = values_of<float>(answer.distances);
    const std::size_t length = std::min(count, n - 1);
    ASSERT_EQ(positions.size(), n);
    ASSERT_EQ(counts, std::vector<std::uint32_t>(n, static_cast<std::uint32_t>(length)));
    ASSERT_EQ(indices.size(), n * length);
    ASSERT_EQ(distances.size(), n * length);
    for (std::uint32_t i = 0; i < n; i += 1 + static_cast<std::uint32_t>(n / 300)) {
      const std::vector<Other> truth = others_of(positions, i);
      for (std::size_t j = 0; j < length; ++j) {
        ASSERT_EQ(indices[i * length + j], truth[j].index) << "neighbour " << j << " of " << i;
        ASSERT_NEAR(distances[i * length + j] / scale, std::sqrt(double{truth[j].square}) / scale, 1e-6);
      }
    }
  }

  static std::vector<Other> others_of(const std::vector<Point>& positions, std::uint32_t i) {
    std::vector<Other> others;
    for (std::uint32_t j = 0; j < positions.size(); ++j) {
      float square = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const float difference = positions[i][k] - positions[j][k];
        square += difference * difference;
      }
      if (i != j) others.push_back({j, square});
    }
    std::sort(others.begin(), others.end(),
              [](const Other& a, const Other& b) { return std::tie(a.square, a.index) < std::tie(b.square, b.index); });
    return others;
  }
};

TEST_F(ServerNeighbours, TheNearestAreThoseOfBruteForce) {
  const auto stub = client();
  const std::string id = make_session(*stub, sphere_off(4));
  for (const v1::Sampler sampler : {v1::SAMPLER_EQUALISED, v1::SAMPLER_PROGRESSIVE}) {
    for (const auto& [n, count] : std::vector<std::pair<std::uint64_t, std::uint32_t>>{{1, 8}, {5, 8}, {3000, 8}, {30'000, 3}}) {
      v1::FindNeighboursRequest wanted = request(id, n);
      wanted.mutable_sample()->set_sampler(sampler);
      wanted.set_count(count);
      const Answer answer = ask(*stub, wanted);
      expect_nearest(answer, n, count);
      EXPECT_TRUE(answer.is_in_order);
      EXPECT_EQ(answer.statistics, 1u);
      EXPECT_EQ(answer.stages, std::set<std::string>{"neighbours"});
      EXPECT_LE(answer.largest, std::size_t{1} << 20);
    }
  }
}

TEST_F(ServerNeighbours, ThePointsAreThoseOfResample) {
  const auto stub = client();
  const std::string id = make_session(*stub, sphere_off(4));
  v1::FindNeighboursRequest wanted = request(id, 3000);
  wanted.set_count(64);
  const Answer one = ask(*stub, wanted), other = ask(*stub, wanted);
  ASSERT_TRUE(one.status.ok()) << one.status.error_message();
  EXPECT_EQ(one.indices, other.indices);
  EXPECT_EQ(one.distances, other.distances);
  std::string positions;
  for (const v1::ResampleResponse& response : resample(*stub, id, wanted.sample()).blocks) {
    positions += response.points().raw().positions();
  }
  EXPECT_EQ(one.positions, positions);
  wanted.mutable_sample()->clear_encoding();
  EXPECT_EQ(ask(*stub, wanted).indices, one.indices) << "Draco rounds what is sent, not what is searched";
}

TEST_F(ServerNeighbours, MeshesOfAnySizeHaveThem) {
  const auto stub = client();
  for (const double scale : {1e-12, 1e14}) {
    const std::string id = make_session(*stub, testing::to_off(testing::scaled(testing::icosphere(3), scale)));
    v1::FindNeighboursRequest wanted = request(id, 1000);
    wanted.set_count(5);
    expect_nearest(ask(*stub, wanted), 1000, 5, scale);
    wanted.set_radius(0.1 * scale);
    const Answer answer = ask(*stub, wanted);
    ASSERT_TRUE(answer.status.ok()) << answer.status.error_message();
    EXPECT_NEAR(static_cast<double>(answer.indices.size()) / 4000, 2.5, 1) << "the share of the sphere times the points";
  }
}

TEST_F(ServerNeighbours, ThoseWithinARadiusAreThoseOfBruteForce) {
  const auto stub = client();
  const std::string id = make_session(*stub, sphere_off(4));
  for (const double radius : {1e-9, 0.07, 0.5, 1e300}) {
    v1::FindNeighboursRequest wanted = request(id, 1000);
    wanted.set_radius(radius);
    const Answer answer = ask(*stub, wanted);
    ASSERT_TRUE(answer.status.ok()) << answer.status.error_message();
    EXPECT_LE(answer.largest, std::size_t{1} << 20);
    const auto positions = values_of<Point>(answer.positions);
    const auto counts = values_of<std::uint32_t>(answer.counts), indices = values_of<std::uint32_t>(answer.indices);
    const auto distances = values_of<float>(answer.distances);
    ASSERT_EQ(counts.size(), 1000u);
    std::size_t begin = 0;
    for (std::uint32_t i = 0; i < 1000; ++i) {
      const auto end = begin + counts[i];
      ASSERT_LE(end, indices.size());
      const std::set<std::uint32_t> found(indices.begin() + static_cast<std::ptrdiff_t>(begin),
                                          indices.begin() + static_cast<std::ptrdiff_t>(end));
      ASSERT_EQ(found.size(), counts[i]);
      ASSERT_TRUE(std::is_sorted(indices.begin() + static_cast<std::ptrdiff_t>(begin),
                                 indices.begin() + static_cast<std::ptrdiff_t>(end)));
      for (; begin < end; ++begin) ASSERT_LE(distances[begin], radius * (1 + 1e-6));
      for (const Other& other : others_of(positions, i)) {
        const double distance = std::sqrt(double{other.square});
        ASSERT_TRUE(distance >= radius * (1 - 1e-6) || found.contains(other.index)) << i << " and " << other.index;
      }
    }
    EXPECT_EQ(begin, indices.size());
    EXPECT_EQ(begin, distances.size());
  }
}

TEST_F(ServerNeighbours, SaysWhatItCannotDo) {
  const auto stub = client();
  const std::string id = make_session(*stub, sphere_off(3));
  const auto expect_refused = [&](const auto& spoil, grpc::StatusCode code, const std::string& why) {
    v1::FindNeighboursRequest bad = request(id, 100);
    bad.set_count(8);
    spoil(bad);
    const grpc::Status status = ask(*stub, bad).status;
    EXPECT_EQ(status.error_code(), code) << why;
    EXPECT_THAT(status.error_message(), HasSubstr(why));
  };
  using Request = v1::FindNeighboursRequest&;
  constexpr grpc::StatusCode kInvalid = grpc::INVALID_ARGUMENT;
  expect_refused([](Request bad) { bad.set_session_id("no session"); }, grpc::NOT_FOUND, "");
  expect_refused([](Request bad) { bad.clear_search(); }, kInvalid, "count is not set, nor is radius");
  expect_refused([](Request bad) { bad.set_count(0); }, kInvalid, "count is 0; it must be from 1 to 64");
  expect_refused([](Request bad) { bad.set_count(65); }, kInvalid, "count is 65");
  expect_refused([](Request bad) { bad.set_radius(0); }, kInvalid, "radius is 0; it must be above 0");
  expect_refused([](Request bad) { bad.set_radius(-1); }, kInvalid, "radius is -1");
  expect_refused([](Request bad) { bad.set_radius(std::numeric_limits<double>::infinity()); }, kInvalid, "radius is not finite");
  expect_refused([](Request bad) { bad.mutable_sample()->set_points(0); }, kInvalid, "sample.points");
  expect_refused([](Request bad) { bad.mutable_sample()->set_max_bytes(100'000); }, kInvalid, "sample has a budget");
  expect_refused([](Request bad) { bad.mutable_sample()->mutable_automatic(); }, kInvalid, "sample has a budget");
  expect_refused([](Request bad) { bad.mutable_sample()->set_points(4'000'001); }, grpc::OUT_OF_RANGE, "4000001 points");
  const auto ask_for_many = [](Request bad) {
    bad.mutable_sample()->set_points(4'000'000);
    bad.set_count(17);
  };
  expect_refused(ask_for_many, grpc::OUT_OF_RANGE, "4000000 points with 17 neighbours each have 68000000; at most 64000000");
  const auto ask_for_all = [](Request bad) {
    bad.mutable_sample()->set_points(520'000);
    bad.set_radius(3);
  };
  expect_refused(ask_for_all, grpc::OUT_OF_RANGE, "radius is 3: there are more than 64000000 neighbours");
  const auto ask_for_nothing = [](Request bad) { bad.mutable_sample()->add_density()->mutable_expression()->set_text("0"); };
  expect_refused(ask_for_nothing, grpc::FAILED_PRECONDITION, "");
}

TEST_F(ServerNeighbours, ClientsMayGo) {
  const auto stub = client();
  const std::string id = make_session(*stub, sphere_off(4));
  v1::FindNeighboursRequest wanted = request(id, 300'000);
  wanted.set_count(32);
  EXPECT_EQ(ask(*stub, wanted, true).status.error_code(), grpc::CANCELLED);
  wanted = request(id, 100);
  wanted.set_count(4);
  EXPECT_TRUE(ask(*stub, wanted).status.ok());
}

}  // namespace
}  // namespace curvecast::server
