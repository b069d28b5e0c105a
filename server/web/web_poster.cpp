#include "server/web/web_poster.h"

#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_split.h>
#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "curvecast/v1/curvecast.grpc.pb.h"
#include "server/convert/convert.h"
#include "server/engine/caller.h"
#include "server/web/web_camera.h"

namespace curvecast::server {
namespace {

constexpr auto kPatience = std::chrono::seconds(5);  // of a page that is loading, for all calls together
constexpr std::uint32_t kPoints = 8'000, kQuality = 70, kListed = 1000;
constexpr double kMargin = 0.04;  // that the viewer leaves free around the whole surface

bool read_flag(absl::string_view text, bool& flag) {
  flag = text == "1";
  return flag || text == "0";
}

bool read_camera(absl::string_view text, v1::Camera& camera) {
  std::vector<double> values;
  for (const absl::string_view part : absl::StrSplit(text, ',')) {
    if (!absl::SimpleAtod(part, &values.emplace_back())) return false;
  }
  if (values.size() != 10) return false;
  *camera.mutable_eye() = to_proto(Vec3d(values[0], values[1], values[2]));
  *camera.mutable_target() = to_proto(Vec3d(values[3], values[4], values[5]));
  *camera.mutable_up() = to_proto(Vec3d(values[6], values[7], values[8]));
  camera.set_vertical_fov_degrees(values[9]);
  return true;
}

bool read_part(absl::string_view name, absl::string_view value, v1::RenderRequest& request) {
  bool flag = false;
  std::uint32_t number = 0;
  if (name == "width" && absl::SimpleAtoi(value, &number)) return request.set_width(number), true;
  if (name == "height" && absl::SimpleAtoi(value, &number)) return request.set_height(number), true;
  if (name == "key") return true;  // is for proxies
  if (name == "session") return request.set_session_id(std::string(value)), true;
  if (name == "camera") return read_camera(value, *request.mutable_sample()->add_cameras());
  if (name == "plain" && read_flag(value, flag)) return request.set_plain(flag), true;
  if (name != "dark" || !read_flag(value, flag)) return false;
  request.set_background(flag ? v1::PICTURE_BACKGROUND_DARK : v1::PICTURE_BACKGROUND_LIGHT);
  return true;
}

/// One request's calls, one after the other. Their callbacks hold it.
class PosterCalls : public std::enable_shared_from_this<PosterCalls> {
 public:
  PosterCalls(const std::shared_ptr<grpc::Channel>& channel, Peer peer, v1::RenderRequest request,
              std::function<void(WebAnswer)> answer)
      : stub_(v1::CurvecastService::NewStub(channel)),
        peer_(std::move(peer)),
        request_(std::move(request)),
        answer_(std::move(answer)) {}

  void begin() {
    if (request_.session_id().empty()) return find_first();
    request_.sample().cameras().empty() ? find_session() : draw();
  }

 private:
  void find_first() {
    list_request_.set_page_size(kListed);
    stub_->async()->ListSessions(
        introduced(), &list_request_, &list_, [self = shared_from_this()](const grpc::Status& /*none: an empty list*/) {
          const auto& all = self->list_.sessions();
          const auto first = std::find_if(all.begin(), all.end(),
                                          [](const v1::Session& session) { return session.state() == v1::SESSION_STATE_READY; });
          first == all.end() ? self->refuse() : self->look_at(*first);
        });
  }

  void find_session() {
    session_request_.set_session_id(request_.session_id());
    stub_->async()->GetSession(introduced(), &session_request_, &session_,
                               [self = shared_from_this()](const grpc::Status& status) {
                                 const bool is_ready = status.ok() && self->session_.session().state() == v1::SESSION_STATE_READY;
                                 is_ready ? self->look_at(self->session_.session()) : self->refuse();
                               });
  }

  void look_at(const v1::Session& session) {
    request_.set_session_id(session.session_id());
    if (request_.sample().cameras().empty()) {
      // As the viewer begins.
      const double aspect = static_cast<double>(request_.width()) / request_.height();
      *request_.mutable_sample()->add_cameras() = whole_view(session.report().mesh(), aspect, terms::kDefaultFovDegrees, kMargin);
    }
    draw();
  }

  void draw() {
    stub_->async()->Render(introduced(), &request_, &picture_, [self = shared_from_this()](const grpc::Status& status) {
      if (!status.ok()) return self->refuse();
      self->answer_({.body = std::move(*self->picture_.mutable_jpeg()), .type = "image/jpeg"});
    });
  }

  void refuse() { answer_({.status = 204}); }

  /// The context of the next call.
  grpc::ClientContext* introduced() {
    context_ = std::make_unique<grpc::ClientContext>();
    introduce(peer_, *context_);
    context_->set_deadline(end_);
    return context_.get();
  }

  const std::unique_ptr<v1::CurvecastService::Stub> stub_;
  const Peer peer_;
  v1::RenderRequest request_;
  const std::function<void(WebAnswer)> answer_;
  const std::chrono::system_clock::time_point end_ = std::chrono::system_clock::now() + kPatience;
  std::unique_ptr<grpc::ClientContext> context_;
  v1::ListSessionsRequest list_request_;
  v1::ListSessionsResponse list_;
  v1::GetSessionRequest session_request_;
  v1::GetSessionResponse session_;
  v1::RenderResponse picture_;
};

}  // namespace

absl::StatusOr<v1::RenderRequest> read_poster_query(std::string_view query) {
  v1::RenderRequest request;
  for (const absl::string_view part : absl::StrSplit(absl::string_view(query.data(), query.size()), '&', absl::SkipEmpty())) {
    const std::pair<absl::string_view, absl::string_view> named = absl::StrSplit(part, absl::MaxSplits('=', 1));
    if (!read_part(named.first, named.second, request)) {
      return absl::InvalidArgumentError(absl::StrCat("\"", part, "\" is nothing that a poster has"));
    }
  }
  if (request.width() == 0 || request.height() == 0 || request.sample().cameras_size() > 1) {
    return absl::InvalidArgumentError("a poster has a width, a height, and one camera at most");
  }
  request.mutable_sample()->set_points(kPoints);
  request.set_format(v1::PICTURE_FORMAT_JPEG);
  request.set_jpeg_quality(kQuality);
  return request;
}

WebLateRoutes::mapped_type posters(std::shared_ptr<grpc::Channel> channel) {
  return [channel = std::move(channel)](const WebQuestion& question, std::function<void(WebAnswer)> answer) {
    absl::StatusOr<v1::RenderRequest> request = read_poster_query(question.query);
    if (!request.ok()) return answer({.status = 400, .body = absl::StrCat(request.status().message(), "\n")});
    std::make_shared<PosterCalls>(channel, question.peer, *std::move(request), std::move(answer))->begin();
  };
}

}  // namespace curvecast::server
