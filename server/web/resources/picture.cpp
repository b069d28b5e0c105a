#include "server/web/resources/picture.h"

#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>

#include <utility>
#include <vector>

#include "proto/terms/density_term.h"
#include "server/base/log.h"
#include "server/web/resources/answers.h"
#include "server/web/resources/json.h"
#include "server/web/web_camera.h"

namespace curvecast::server {
namespace {

using Async = v1::CurvecastService::StubInterface::async_interface;
using Part = std::pair<std::string, std::string>;

constexpr std::uint32_t kWidth = 1280, kHeight = 960;  // of RenderRequest, where it says nothing

struct PictureTerms {
  v1::RenderRequest request;
  std::vector<terms::CameraTerm> cameras;
};

bool read_number(const std::string& text, std::uint32_t most, std::uint32_t& number) {
  return absl::SimpleAtoi(text, &number) && number <= most;
}

bool read_choice(const Part& part, v1::RenderRequest& request) {
  const auto& [name, value] = part;
  if (name == "what" && value == "surface") return request.set_style(v1::PICTURE_STYLE_SURFACE), true;
  if (name == "what" && value == "dots") return request.set_style(v1::PICTURE_STYLE_DOTS), true;
  if (name == "what" && value == "shaded") return request.set_style(v1::PICTURE_STYLE_MESH), true;
  if (name == "plain" && (value == "true" || value == "false")) return request.set_plain(value == "true"), true;
  if (name == "background" && value == "light") return request.set_background(v1::PICTURE_BACKGROUND_LIGHT), true;
  if (name == "background" && value == "dark") return request.set_background(v1::PICTURE_BACKGROUND_DARK), true;
  return false;
}

absl::Status read_part(const Part& part, PictureTerms& terms) {
  v1::RenderRequest& request = terms.request;
  const auto& [name, value] = part;
  std::uint32_t number = 0;
  constexpr std::uint32_t kMost = 1'000'000;  // the call itself says how many pixels there may be
  if (name == "width" && read_number(value, kMost, number)) return request.set_width(number), absl::OkStatus();
  if (name == "height" && read_number(value, kMost, number)) return request.set_height(number), absl::OkStatus();
  if (name == "quality" && read_number(value, kMost, number)) return request.set_jpeg_quality(number), absl::OkStatus();
  std::uint64_t n = 0;
  if (name == "n" && absl::SimpleAtoi(value, &n)) return request.mutable_sample()->set_points(n), absl::OkStatus();
  if (name == "density") {
    absl::StatusOr<v1::DensityTerm> term = terms::parse_density_term(value);
    if (term.ok()) *request.mutable_sample()->add_density() = *std::move(term);
    return term.status();
  }
  if (name == "camera") {
    const absl::StatusOr<terms::CameraTerm> camera = terms::parse_camera_term(value);
    if (!camera.ok()) return camera.status();
    if (camera->aspect)
      return absl::InvalidArgumentError("camera: a picture's aspect is that of width and height; leave aspect= out");
    if (!terms.cameras.empty()) return absl::InvalidArgumentError("camera: a picture has one");
    return terms.cameras.push_back(*camera), absl::OkStatus();
  }
  if (read_choice(part, request)) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("query: '", printable(name + "=" + value),
                                                 "' is nothing that a picture has; there are: width, height, camera, "
                                                 "what=surface|dots|shaded, n, density, plain=true|false, "
                                                 "background=light|dark, quality"));
}

void draw(const std::shared_ptr<WebResource>& resource, const v1::Session& session, PictureTerms terms) {
  const std::string tag = etag_of(session, resource->request());
  if (matches(resource->request(), tag)) return resource->answer(not_modified(tag));
  v1::RenderRequest& request = terms.request;
  const double width = request.width() == 0 ? kWidth : request.width();
  const double height = request.height() == 0 ? kHeight : request.height();
  if (terms.cameras.empty()) terms.cameras.emplace_back();
  absl::StatusOr<v1::Camera> camera = complete_camera(terms.cameras.front(), session.report().mesh(), width / height);
  if (!camera.ok()) return resource->fail(camera.status());
  *request.mutable_sample()->add_cameras() = *std::move(camera);
  if (request.sample().points() == 0) request.mutable_sample()->set_points(session.options().max_points());
  request.set_session_id(session.session_id());
  const std::uint64_t wanted = request.sample().points();
  const bool is_png = request.format() == v1::PICTURE_FORMAT_PNG;
  const bool has_points = request.style() != v1::PICTURE_STYLE_MESH;
  resource->call<v1::RenderRequest, v1::RenderResponse>(&Async::Render, std::move(request), [=](v1::RenderResponse picture) {
    // With fewer points than were asked for it may become better.
    const bool is_final = !has_points || picture.points() == wanted;
    std::string& bytes = is_png ? *picture.mutable_png() : *picture.mutable_jpeg();
    WebAnswer answer = file_answer(std::move(bytes), is_png ? "image/png" : "image/jpeg", is_final ? tag : "");
    answer.held = hold_queued(resource->engine(), resource->caller(), answer.body.size());
    resource->answer(std::move(answer));
  });
}

}  // namespace

void get_picture(const std::shared_ptr<WebResource>& resource, const std::string& session_id, v1::PictureFormat format) {
  PictureTerms terms;
  terms.request.set_format(format);
  for (const Part& part : resource->query()) {
    if (absl::Status status = read_part(part, terms); !status.ok()) return resource->fail(status);
  }
  v1::GetSessionRequest request;
  request.set_session_id(session_id);
  resource->call<v1::GetSessionRequest, v1::GetSessionResponse>(
      &Async::GetSession, std::move(request),
      [resource, terms = std::move(terms)](const v1::GetSessionResponse& found) { draw(resource, found.session(), terms); });
}

}  // namespace curvecast::server
