#include "server/convert/convert.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "server/convert/convert_points.h"
#include "tests/server/frame/sample_request.h"

namespace curvecast::server {
namespace {

using Code = absl::StatusCode;
using ::testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

TEST(ToPointSetRequest, FillsInTheDefaults) {
  const auto sample = to_point_set_request(good_request());
  ASSERT_TRUE(sample.ok()) << sample.status();
  EXPECT_EQ(sample->options.points, 1000u);
  EXPECT_EQ(sample->options.seed, 7u);
  EXPECT_EQ(sample->options.sequence, Sequence::kJittered);
  ASSERT_EQ(sample->options.density.terms.size(), 9u);
  EXPECT_TRUE(std::holds_alternative<UniformTerm>(sample->options.density.terms[0]));
  const auto& curvature = std::get<CurvatureTerm>(sample->options.density.terms[1]);
  EXPECT_EQ(curvature.kind, CurvatureKind::kGauss);
  EXPECT_EQ(curvature.exponent, 1);
  EXPECT_EQ(curvature.floor, 0.05);
  const auto& view = std::get<ViewTerm>(sample->options.density.terms[2]);
  EXPECT_EQ(view.s0, 0.1);
  EXPECT_EQ(std::get<AttributeTerm>(sample->options.density.terms[3]).name, "heat");
  const Dab& brush = std::get<BrushTerm>(sample->options.density.terms[4]).dabs.at(0);
  EXPECT_EQ(brush.centre, Vec3d(1, 0, 0));
  EXPECT_EQ(brush.radius, 2);
  EXPECT_EQ(brush.factor, 3);
  EXPECT_EQ(brush.falloff, 0.5);
  const auto& distance = std::get<DistanceTerm>(sample->options.density.terms[5]);
  EXPECT_EQ(distance.near, 0);
  EXPECT_EQ(distance.far, kInf);
  EXPECT_FALSE(distance.global);
  EXPECT_TRUE(std::holds_alternative<FrustumTerm>(sample->options.density.terms[6]));
  EXPECT_TRUE(std::holds_alternative<ScreenTerm>(sample->options.density.terms[7]));
  EXPECT_EQ(std::get<ExpressionTerm>(sample->options.density.terms[8]).text, "1 + heat");
  ASSERT_EQ(sample->options.density.cameras.size(), 1u);
  const Camera& camera = sample->options.density.cameras[0];
  EXPECT_EQ(camera.eye, Vec3d(0, 0, 3));
  EXPECT_EQ(camera.target, Vec3d(0, 0, 0));
  EXPECT_EQ(camera.up, Vec3d(0, 1, 0));
  EXPECT_EQ(camera.fov, std::acos(-1) / 4);
  EXPECT_FALSE(camera.is_orthographic());
  EXPECT_EQ(camera.aspect, 4.0 / 3);
  EXPECT_EQ(camera.pixels, 480);
  EXPECT_EQ(sample->pixel_error, 0);
  EXPECT_EQ(sample->max_bytes, 0u);
  ASSERT_TRUE(sample->draco);
  EXPECT_EQ(sample->draco->position_bits, kAutomaticBits);
  EXPECT_EQ(sample->draco->normal_bits, 8);
}

TEST(ToPointSetRequest, TakesWhatIsSet) {
  v1::SampleRequest request = good_request();
  request.set_sequence(v1::SEQUENCE_REGULAR);
  auto& curvature = *request.mutable_density(1)->mutable_curvature();
  curvature.set_kind(v1::CURVATURE_KIND_MAX);
  curvature.set_exponent(0);
  curvature.set_floor(0);
  request.mutable_density(2)->mutable_view()->set_s0(2);
  request.mutable_encoding()->mutable_draco()->set_position_bits(30);
  request.mutable_encoding()->mutable_draco()->set_normal_bits(2);
  auto sample = to_point_set_request(request);
  ASSERT_TRUE(sample.ok()) << sample.status();
  EXPECT_EQ(sample->options.sequence, Sequence::kRegular);
  request.set_sequence(v1::SEQUENCE_VAN_DER_CORPUT);
  EXPECT_EQ(to_point_set_request(request)->options.sequence, Sequence::kVanDerCorput);
  request.set_sequence(v1::SEQUENCE_GOLDEN_RATIO);
  EXPECT_EQ(to_point_set_request(request)->options.sequence, Sequence::kGoldenRatio);
  EXPECT_EQ(std::get<CurvatureTerm>(sample->options.density.terms[1]).kind, CurvatureKind::kMax);
  EXPECT_EQ(std::get<CurvatureTerm>(sample->options.density.terms[1]).exponent, 0);
  EXPECT_EQ(std::get<CurvatureTerm>(sample->options.density.terms[1]).floor, 0);
  EXPECT_EQ(std::get<ViewTerm>(sample->options.density.terms[2]).s0, 2);
  EXPECT_EQ(sample->draco->position_bits, 30);
  EXPECT_EQ(sample->draco->normal_bits, 2);
  request.mutable_encoding()->mutable_raw();
  sample = to_point_set_request(request);
  ASSERT_TRUE(sample.ok());
  EXPECT_FALSE(sample->draco);
}

TEST(ToPointSetRequest, NamesTheFieldAtFault) {
  expect_refusals({
      {"sample.points is 0", [](auto& r) { r.set_points(0); }},
      {"sample.viewport.width is 0", [](auto& r) { r.mutable_viewport()->set_width(0); }},
      {"sample.viewport.height is 0", [](auto& r) { r.mutable_viewport()->set_height(0); }},
      {"sample.points is 0", [](auto& r) { r.clear_budget(); }},
      {"sample.pixel_error is 0", [](auto& r) { r.set_pixel_error(0); }},
      {"sample.pixel_error is -1", [](auto& r) { r.set_pixel_error(-1); }},
      {"sample.pixel_error is nan", [](auto& r) { r.set_pixel_error(kNan); }},
      {"sample.pixel_error is inf", [](auto& r) { r.set_pixel_error(kInf); }},
      {"sample.pixel_error needs a camera",
       [](auto& r) {
         r.set_pixel_error(1);
         r.clear_cameras();
       }},
      {"sample.max_bytes is 1023", [](auto& r) { r.set_max_bytes(1023); }},
      {"sample.sequence has the unknown value -5", [](auto& r) { r.set_sequence(static_cast<v1::Sequence>(-5)); }},
      {"sample.encoding.draco.position_bits is 31",
       [](auto& r) { r.mutable_encoding()->mutable_draco()->set_position_bits(31); }},
      {"sample.encoding.draco.normal_bits is 1", [](auto& r) { r.mutable_encoding()->mutable_draco()->set_normal_bits(1); }},
      {"sample.encoding.draco.normal_bits is 4294967295",
       [](auto& r) { r.mutable_encoding()->mutable_draco()->set_normal_bits(~0u); }},
  });
}

TEST(ToPointSetRequest, RelaxesEqualisedPointsOnly) {
  v1::SampleRequest request = good_request();
  request.set_relaxation_rounds(100);
  ASSERT_TRUE(to_point_set_request(request).ok());
  EXPECT_EQ(to_point_set_request(request)->relaxation_rounds, 100);
  EXPECT_TRUE(absl::IsInvalidArgument(to_streamed_request(request).status()));
  expect_refusals({{"sample.relaxation_rounds", [](auto& r) { r.set_relaxation_rounds(101); }},
                   {"sample.relaxation_rounds is for the equalised sampler", [](auto& r) {
                      r.set_relaxation_rounds(1);
                      r.set_sampler(v1::SAMPLER_PROGRESSIVE);
                    }}});
  request.set_relaxation_rounds(0);
  EXPECT_TRUE(to_streamed_request(request).ok());
}

TEST(ToPreprocessOptions, ChecksAndFillsIn) {
  const auto convert = [](std::uint64_t points, double omega) {
    v1::SessionOptions options;
    options.set_max_points(points);
    options.set_omega(omega);
    return to_preprocess_options(options);
  };
  const auto defaults = convert(0, 0);
  ASSERT_TRUE(defaults.ok());
  EXPECT_EQ(defaults->points, 65'536u);
  EXPECT_EQ(defaults->omega, 10);
  EXPECT_TRUE(convert(1, 1).ok());
  EXPECT_TRUE(convert(4'000'000, 0).ok());
  EXPECT_TRUE(convert(100, 1000).ok());
  for (const double omega : {0.5, -1.0, 1000.1, kNan, kInf}) {
    EXPECT_EQ(convert(0, omega).status().code(), Code::kInvalidArgument) << omega;
    EXPECT_THAT(convert(0, omega).status().message(), HasSubstr("options.omega")) << omega;
  }
  const auto divided = [](std::uint64_t chart_faces) {
    v1::SessionOptions options;
    options.set_chart_faces(chart_faces);
    return to_preprocess_options(options);
  };
  EXPECT_EQ(defaults->chart_faces, 0u);
  EXPECT_EQ(divided(5000)->chart_faces, 5000u);
  for (const std::uint64_t few_or_many : {std::uint64_t{1}, std::uint64_t{999}, ~std::uint64_t{0}}) {
    EXPECT_THAT(divided(few_or_many).status().message(), HasSubstr("options.chart_faces is ")) << few_or_many;
  }
  const auto creased = [](double degrees) {
    v1::SessionOptions options;
    options.set_crease_degrees(degrees);
    return to_preprocess_options(options);
  };
  EXPECT_EQ(defaults->crease_degrees, std::nullopt);
  for (const double degrees : {0.0, 22.5, 180.0}) EXPECT_EQ(creased(degrees)->crease_degrees, degrees);
  for (const double degrees : {-0.1, 180.1, kNan, kInf}) {
    EXPECT_EQ(creased(degrees).status().code(), Code::kInvalidArgument) << degrees;
    EXPECT_THAT(creased(degrees).status().message(), HasSubstr("options.crease_degrees")) << degrees;
  }
  EXPECT_THAT(convert(4'000'001, 0).status().message(), HasSubstr("options.max_points is 4000001"));
  EXPECT_EQ(convert(~std::uint64_t{0}, 0).status().code(), Code::kInvalidArgument);
  EXPECT_THAT(convert(4'000'000, 1000).status().message(), HasSubstr("curve vertices"));
  EXPECT_EQ(defaults->parameteriser, Parameteriser::kLeastStretch);
  v1::SessionOptions options;
  options.set_parameteriser(v1::PARAMETERISER_CGAL);
  EXPECT_EQ(to_preprocess_options(options)->parameteriser, Parameteriser::kCgal);
  options.set_parameteriser(static_cast<v1::Parameteriser>(7));
  EXPECT_THAT(to_preprocess_options(options).status().message(), HasSubstr("options.parameteriser has the unknown value 7"));
}

TEST(ToPreprocessOptions, TakesMapperAreaElementAndBaseDensity) {
  v1::SessionOptions options;
  auto converted = to_preprocess_options(options);
  ASSERT_TRUE(converted.ok());
  EXPECT_EQ(converted->mapper, Mapper::kExact);
  EXPECT_EQ(converted->area_element, AreaElement::kExact);
  EXPECT_TRUE(converted->density.empty());
  options.set_mapper(v1::MAPPER_ID_BUFFER);
  options.set_area_element(v1::AREA_ELEMENT_VORONOI);
  options.set_seed(11);
  options.add_density()->mutable_uniform();
  v1::CurvatureDensity& curvature = *options.add_density()->mutable_curvature();
  curvature.set_kind(v1::CURVATURE_KIND_MEAN);
  curvature.set_exponent(0.5);
  converted = to_preprocess_options(options);
  ASSERT_TRUE(converted.ok()) << converted.status();
  EXPECT_EQ(converted->mapper, Mapper::kIdBuffer);
  EXPECT_EQ(converted->area_element, AreaElement::kVoronoi);
  ASSERT_EQ(converted->density.size(), 2u);
  EXPECT_TRUE(std::holds_alternative<UniformTerm>(converted->density[0]));
  EXPECT_EQ(std::get<CurvatureTerm>(converted->density[1]).kind, CurvatureKind::kMean);
  EXPECT_EQ(std::get<CurvatureTerm>(converted->density[1]).exponent, 0.5);
  EXPECT_EQ(std::get<CurvatureTerm>(converted->density[1]).floor, 0.05);
  // And back, with the defaults filled in.
  converted->density.insert(converted->density.end(),
                            {AttributeTerm{"heat"}, BrushTerm{{{{1, 2, 3}, 4, 5, 0.25}}}, ExpressionTerm{"x"}});
  const v1::SessionOptions back = to_proto(SessionInfo{"id", "mesh", *converted, SessionState::kQueued, nullptr}).options();
  EXPECT_EQ(back.mapper(), v1::MAPPER_ID_BUFFER);
  EXPECT_EQ(back.area_element(), v1::AREA_ELEMENT_VORONOI);
  EXPECT_EQ(back.seed(), 11u);
  ASSERT_EQ(back.density_size(), 5);
  EXPECT_TRUE(back.density(0).has_uniform());
  EXPECT_EQ(back.density(1).curvature().kind(), v1::CURVATURE_KIND_MEAN);
  EXPECT_EQ(back.density(1).curvature().exponent(), 0.5);
  EXPECT_EQ(back.density(1).curvature().floor(), 0.05);
  EXPECT_EQ(back.density(2).attribute().name(), "heat");
  EXPECT_EQ(back.density(3).brush().strokes(0).centre().z(), 3);
  EXPECT_EQ(back.density(3).brush().strokes(0).radius(), 4);
  EXPECT_EQ(back.density(3).brush().strokes(0).factor(), 5);
  EXPECT_EQ(back.density(3).brush().strokes(0).falloff(), 0.25);
  EXPECT_EQ(back.density(4).expression().text(), "x");
  EXPECT_EQ(to_preprocess_options(back)->density.size(), 5u);
}

TEST(ToPreprocessOptions, NamesTheFieldAtFault) {
  const auto expect_refusal = [](const char* message, const std::function<void(v1::SessionOptions&)>& spoil) {
    v1::SessionOptions options;
    spoil(options);
    const auto converted = to_preprocess_options(options);
    EXPECT_EQ(converted.status().code(), Code::kInvalidArgument) << message;
    EXPECT_THAT(converted.status().message(), HasSubstr(message));
  };
  expect_refusal("options.mapper has the unknown value 5", [](auto& o) { o.set_mapper(static_cast<v1::Mapper>(5)); });
  expect_refusal("options.area_element has the unknown value -1",
                 [](auto& o) { o.set_area_element(static_cast<v1::AreaElement>(-1)); });
  expect_refusal("options.density[1] depends on a camera", [](auto& o) {
    o.add_density()->mutable_uniform();
    o.add_density()->mutable_view();
  });
  expect_refusal("options.density[0] holds no term", [](auto& o) { o.add_density(); });
  expect_refusal("options.density[0].curvature.floor is 2", [](auto& o) { o.add_density()->mutable_curvature()->set_floor(2); });
  expect_refusal("options.density has 17 terms", [](auto& o) {
    while (o.density_size() < 17) o.add_density()->mutable_uniform();
  });
}

TEST(ToProto, RawBlocksHoldTheFloatsThemselves) {
  PointSet points;
  points.origin = {1, 2, 3};
  for (int i = 0; i < 10; ++i) {
    const auto value = static_cast<float>(i);
    points.positions.emplace_back(value, value + 0.25f, value + 0.5f);
    points.normals.emplace_back(0.f, 0.f, 1.f);
    points.radii.push_back(value / 8);
    points.vertices.push_back(i);
  }
  const auto block = to_proto(points, 4, 3, Box3d(), std::nullopt);
  ASSERT_TRUE(block.ok());
  EXPECT_EQ(block->count(), 3u);
  EXPECT_EQ(block->origin().y(), 2);
  ASSERT_EQ(block->raw().positions().size(), 36u);
  ASSERT_EQ(block->raw().normals().size(), 36u);
  ASSERT_EQ(block->raw().radii().size(), 12u);
  EXPECT_EQ(std::memcmp(block->raw().positions().data(), &points.positions[4], 36), 0);
  EXPECT_EQ(std::memcmp(block->raw().radii().data(), &points.radii[4], 12), 0);
  EXPECT_TRUE(block->raw().colours().empty());
}

TEST(ToProto, ColoursGoWithTheirPoints) {
  PointSet points;
  SurfaceCurve curve;
  curve.box = {Vec3d(0, 0, 0), Vec3d(9, 9, 9)};
  for (std::uint8_t i = 0; i < 10; ++i) {
    points.positions.emplace_back(i, i, i);
    points.normals.emplace_back(0.f, 0.f, 1.f);
    points.radii.push_back(1);
    points.vertices.push_back(i);
    points.colours.push_back({i, 20, 200, 77});
  }
  const auto raw = to_proto(points, 4, 2, curve.box, std::nullopt);
  ASSERT_TRUE(raw.ok());
  EXPECT_EQ(raw->raw().colours(), "\x04\x14\xc8\x05\x14\xc8");
  const auto whole = to_proto(points, 0, 10, curve.box, DracoOptions());
  const auto part = to_proto(points, 4, 2, curve.box, DracoOptions());
  ASSERT_TRUE(whole.ok() && part.ok());
  points.colours.clear();
  EXPECT_GT(whole->draco().data().size(), to_proto(points, 0, 10, curve.box, DracoOptions())->draco().data().size());
  EXPECT_GT(part->draco().data().size(), to_proto(points, 4, 2, curve.box, DracoOptions())->draco().data().size());
}

TEST(ToProto, SessionsSayWhatTheyAre) {
  SessionInfo info{"id", "mesh", {.points = 5, .omega = 2}, SessionState::kPreprocessing, nullptr};
  EXPECT_EQ(to_proto(info).state(), v1::SESSION_STATE_PREPROCESSING);
  EXPECT_FALSE(to_proto(info).has_report());
  auto session = std::make_shared<Session>();
  session->id = "id";
  session->mesh_name = "bunny.ply";
  session->options = info.options;
  auto curve = std::make_shared<SurfaceCurve>();
  curve->revision = 3;
  session->revisions->publish(curve);
  session->preprocessed.report.mesh.genus = 2;
  session->preprocessed.report.mesh.attributes = {"uv"};
  session->preprocessed.report.mesh.warnings = {"One.", "Two."};
  session->peak_bytes = 12;
  info.session = session;
  const v1::Session ready = to_proto(info);
  EXPECT_EQ(ready.state(), v1::SESSION_STATE_READY);
  EXPECT_EQ(ready.curve_revision(), 3u);
  EXPECT_EQ(ready.options().max_points(), 5u);
  EXPECT_EQ(ready.report().mesh().name(), "bunny.ply");
  EXPECT_EQ(ready.report().mesh().genus(), 2u);
  EXPECT_THAT(ready.report().mesh().attributes(), ::testing::ElementsAre("uv"));
  EXPECT_THAT(ready.report().mesh().warnings(), ::testing::ElementsAre("One.", "Two."));
  EXPECT_EQ(ready.report().peak_bytes(), 12u);
}

}  // namespace
}  // namespace curvecast::server
