// Posters, over the HTTP port of a whole server.
#include <absl/strings/str_cat.h>
#include <gmock/gmock.h>

#include <cmath>
#include <string>

#include "core/mesh_io/reading/texture_image.h"
#include "server/web/web_poster.h"
#include "tests/server/server_fixture.h"
#include "tests/server/web/http_client.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;

TEST(PosterQuery, SaysWhatIsDrawn) {
  const auto all = read_poster_query("width=320&height=200&key=0123&session=abc&camera=1,2,3,4,5,6,0,0,1,35.5&dark=1&plain=1");
  ASSERT_TRUE(all.ok()) << all.status();
  EXPECT_EQ(all->width(), 320u);
  EXPECT_EQ(all->height(), 200u);
  EXPECT_EQ(all->session_id(), "abc");
  EXPECT_EQ(all->format(), v1::PICTURE_FORMAT_JPEG);
  EXPECT_EQ(all->background(), v1::PICTURE_BACKGROUND_DARK);
  EXPECT_TRUE(all->plain());
  ASSERT_EQ(all->sample().cameras_size(), 1);
  const v1::Camera& camera = all->sample().cameras(0);
  EXPECT_EQ(camera.eye().y(), 2);
  EXPECT_EQ(camera.target().z(), 6);
  EXPECT_EQ(camera.up().z(), 1);
  EXPECT_EQ(camera.vertical_fov_degrees(), 35.5);
  const auto least = read_poster_query("width=1&height=2");
  ASSERT_TRUE(least.ok()) << least.status();
  EXPECT_EQ(least->session_id(), "");
  EXPECT_TRUE(least->sample().cameras().empty());
  EXPECT_FALSE(least->plain());
}

TEST(PosterQuery, RefusesWhatMeansNothing) {
  for (const char* query : {"", "width=1", "width=0&height=1", "width=-1&height=1", "width=1&height=x", "width=1&height=1&dark=2",
                            "width=1&height=1&x", "width=1&height=1&camera=1,2,3", "width=1&height=1&camera=1,2,3,4,5,6,7,8,9,x",
                            "width=1&height=1&camera=1,2,3,4,5,6,0,0,1,30&camera=1,2,3,4,5,6,0,0,1,30"}) {
    EXPECT_EQ(read_poster_query(query).status().code(), absl::StatusCode::kInvalidArgument) << query;
  }
}

class ServerPoster : public ServerFixture {
 protected:
  void SetUp() override { start({.http = "127.0.0.1:0"}); }

  HttpClient::Response poster(const std::string& query, const std::string& more = "") {
    HttpClient client(server_->http_port());
    client.send(
        absl::StrCat("GET ", kPosterPath, "?", query, " HTTP/1.1\r\nHost: localhost\r\nCurvecast-Page: 1\r\n", more, "\r\n"));
    return client.receive();
  }
  std::string make_ball() { return create(*client(), upload(*client(), sphere_off(3)), 2000).session.session_id(); }
};

/// Half the height of what stands out of the left column's colours in the middle column, pixels.
double ball_radius(const Image& image) {
  int rows = 0;
  for (int y = 0; y < image.height; ++y) {
    const auto at = [&](int x) { return &image.rgba[4 * static_cast<std::size_t>(y * image.width + x)]; };
    int most = 0;
    for (int channel = 0; channel < 3; ++channel) {
      most = std::max(most, std::abs(int{at(image.width / 2)[channel]} - int{at(0)[channel]}));
    }
    rows += most > 12 ? 1 : 0;
  }
  return rows / 2.0;
}

TEST_F(ServerPoster, IsOfTheFirstSessionThatIsReady) {
  EXPECT_EQ(poster("width=160&height=120").status, 204);  // there is none yet
  const std::string id = make_ball();
  const HttpClient::Response first = poster("width=160&height=120");
  ASSERT_EQ(first.status, 200);
  EXPECT_THAT(first.header, HasSubstr("Content-Type: image/jpeg\r\n"));
  EXPECT_THAT(first.header, HasSubstr("Cache-Control: no-store\r\n"));
  EXPECT_EQ(poster(absl::StrCat("width=160&height=120&session=", id)).body, first.body);
  const absl::StatusOr<Image> image = decode_texture(first.body, 1 << 20);
  ASSERT_TRUE(image.ok()) << image.status();
  EXPECT_EQ(image->width, 160);
  EXPECT_EQ(image->height, 120);
  EXPECT_GT(ball_radius(*image), 20);
}

TEST_F(ServerPoster, HasTheCameraThatIsAskedFor) {
  const std::string id = make_ball();
  const HttpClient::Response far = poster(absl::StrCat("width=160&height=120&session=", id, "&camera=0,0,4,0,0,0,0,1,0,40"));
  const absl::StatusOr<Image> image = decode_texture(far.body, 1 << 20);
  ASSERT_TRUE(image.ok()) << image.status();
  EXPECT_NEAR(ball_radius(*image), 42.6, 2);
  EXPECT_EQ(poster(absl::StrCat("width=160&height=120&session=", id, "&camera=0,0,4,0,0,4,0,1,0,40")).status, 204);
  EXPECT_EQ(poster(absl::StrCat("width=160&height=120&session=", id, "&camera=nan,0,4,0,0,0,0,1,0,40")).status, 204);
}

TEST_F(ServerPoster, SaysWhereThereIsNone) {
  make_ball();
  EXPECT_EQ(poster("width=160&height=120&session=00000000000000000000000000000000").status, 204);
  EXPECT_EQ(poster("width=5000&height=120").status, 204);
  const HttpClient::Response nonsense = poster("width=160&height=120&colour=red");
  EXPECT_EQ(nonsense.status, 400);
  EXPECT_THAT(nonsense.body, HasSubstr("colour=red"));
}

TEST_F(ServerPoster, IsForThoseWhoMaySeeTheSession) {
  const testing::TemporaryFolder folder;
  // printf %s "anna's" | sha256sum
  testing::write_file(folder / "tokens", "anna 8f68ce373d4607a65f1b1ce5c42eef43dcc492fdf17a5bb36bdca6d656ca21da\n");
  start({.tokens = folder / "tokens", .http = "127.0.0.1:0"});
  const auto stub = client_with("anna's");
  create(*stub, upload(*stub, sphere_off(3)), 2000);
  EXPECT_EQ(poster("width=160&height=120").status, 204);
  EXPECT_EQ(poster("width=160&height=120", "Authorization: Bearer bert's\r\n").status, 204);
  EXPECT_EQ(poster("width=160&height=120", "Authorization: Bearer anna's\r\n").status, 200);
}

}  // namespace
}  // namespace curvecast::server
