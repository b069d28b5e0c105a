#include "client/cli/session_flags.h"

#include <CLI/CLI.hpp>
#include <array>
#include <span>
#include <string_view>
#include <utility>

#include "client/cli/choice.h"
#include "client/cli/common.h"
#include "client/cli/density_term.h"

namespace curvecast::cli {
namespace {

constexpr std::array<std::string_view, 2> kParameterisers = {"own", "cgal"};
constexpr std::array<std::string_view, 2> kMappers = {"exact", "id-buffer"};
constexpr std::array<std::string_view, 2> kAreas = {"exact", "voronoi"};

absl::Status check_base_term(const std::string& text) {
  const absl::StatusOr<v1::DensityTerm> term = parse_density_term(text);
  if (!term.ok()) return term.status();
  if (!is_camera_term(*term)) return absl::OkStatus();
  return absl::InvalidArgumentError(
      "a base density cannot depend on a camera; there are: uniform, curvature, attribute, brush, expression");
}

}  // namespace

CLI::Option* add_session_flags(CLI::App* command, SessionFlags* flags) {
  command
      ->add_option("--base-density", flags->base_density,
                   "a factor of the density for which the curve is made; repeat to multiply: uniform, curvature[:...], "
                   "attribute:NAME, brush:..., expression:... as in --density; default: uniform")
      ->check(validator(check_base_term, ""))
      ->type_name("TERM")
      ->allow_extra_args(false);
  CLI::Option* const omega = command->add_option("--omega", flags->omega, "curve vertices per point, 1 to 1,000; default: 10")
                                 ->check(CLI::Range(1.0, 1000.0))
                                 ->type_name("W");
  command
      ->add_option("--crease", flags->crease,
                   "edges at which faces turn by more than so many degrees are sharp: normals do not lean over them; from 0, "
                   "where all are, to 180, where none are; default: as the file's own normals or smoothing groups mean, else 40")
      ->check(CLI::Range(0.0, 180.0))
      ->type_name("DEGREES");
  command
      ->add_option("--chart-faces", flags->chart_faces,
                   "divide the mesh into charts of about so many faces, from 1,000 on; default: components of more than "
                   "1,000,000, into charts of 100,000; those with many tunnels or holes may be divided further")
      ->check(CLI::Range(std::uint64_t{1000}, std::uint64_t{1} << 32))
      ->type_name("F");
  const auto add_choice = [&](const char* name, const char* what, std::string* value, std::span<const std::string_view> values,
                              const char* description) {
    command->add_option(name, *value, description)
        ->check(validator([=](const std::string& text) { return check_choice(what, text, values); }, ""))
        ->type_name("NAME")
        ->capture_default_str();
  };
  add_choice("--parameteriser", "parameteriser", &flags->parameteriser, kParameterisers,
             "own, or cgal: CGAL's mean value parameteriser, for comparison; slower, more distortion");
  add_choice("--mapper", "mapper", &flags->mapper, kMappers,
             "what finds the triangle under each curve vertex: exact, or id-buffer (pictures of the parameter mesh)");
  add_choice("--area", "area element", &flags->area, kAreas,
             "what counts as the surface around a curve vertex: exact, or voronoi (the paper's)");
  return omega;
}

absl::Status check_without_session(const SessionFlags& flags) {
  const SessionFlags usual;
  const char* const name = !flags.base_density.empty()                  ? "--base-density"
                           : flags.omega != usual.omega                 ? "--omega"
                           : flags.chart_faces != usual.chart_faces     ? "--chart-faces"
                           : flags.parameteriser != usual.parameteriser ? "--parameteriser"
                           : flags.mapper != usual.mapper               ? "--mapper"
                           : flags.area != usual.area                   ? "--area"
                                                                        : nullptr;
  if (name == nullptr) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(name, " says how a mesh is prepared; for --sampler scattered it is not: leave one of the two out"));
}

absl::StatusOr<v1::SessionOptions> make_session_options(const SessionFlags& flags, std::uint64_t points, std::uint64_t seed) {
  v1::SessionOptions options;
  options.set_max_points(points);
  options.set_seed(seed);
  options.set_omega(flags.omega);
  if (flags.crease) options.set_crease_degrees(*flags.crease);
  options.set_chart_faces(flags.chart_faces);
  options.set_parameteriser(flags.parameteriser == "cgal" ? v1::PARAMETERISER_CGAL : v1::PARAMETERISER_OWN);
  options.set_mapper(flags.mapper == "id-buffer" ? v1::MAPPER_ID_BUFFER : v1::MAPPER_EXACT);
  options.set_area_element(flags.area == "voronoi" ? v1::AREA_ELEMENT_VORONOI : v1::AREA_ELEMENT_EXACT);
  if (absl::Status status = add_density_terms(flags.base_density, options.mutable_density()); !status.ok()) return status;
  return options;
}

std::string mapper_name(v1::Mapper mapper) { return mapper == v1::MAPPER_ID_BUFFER ? "id-buffer" : "exact"; }

std::string area_name(v1::AreaElement area) { return area == v1::AREA_ELEMENT_VORONOI ? "voronoi" : "exact"; }

}  // namespace curvecast::cli
