#include "server/web/resources/tileset_terms.h"

#include <absl/strings/ascii.h>
#include <absl/strings/escaping.h>
#include <absl/strings/str_cat.h>

#include <algorithm>
#include <cstddef>

#include "proto/terms/density_term.h"
#include "server/web/resources/points_terms.h"
#include "server/web/resources/query.h"

namespace curvecast::server {
namespace {

using Part = std::pair<std::string, std::string>;

constexpr std::size_t kMostText = 3000;  // bytes: addresses of tiles have to fit into a request's header, of 8 KiB
constexpr std::size_t kDigestSize = 32;
constexpr char kParts[] = "n, density, up=y|z, glb=floats|quantised|meshopt";

absl::Status read_part(const Part& part, PointsTerms& points, TilesetTerms& terms) {
  const auto& [name, value] = part;
  if (name == "n" || name == "density") {
    const bool is_twice = name == "n" && points.sample.has_points();
    if (is_twice) return bad_query_part(part, "n is given more than once");
    if (absl::Status status = *read_sample_part(part, points); !status.ok()) return status;
    if (name == "density" && terms::is_camera_term(*points.sample.density().rbegin())) {
      return bad_query_part(part, "this density depends on a camera, and tiles are the same for all of them");
    }
    return absl::OkStatus();
  }
  if (name == "up" && (value == "y" || value == "z")) return terms.options.z_up = value == "z", absl::OkStatus();
  if (name == "glb" && (value == "floats" || value == "quantised" || value == "meshopt")) {
    terms.options.content = {.quantise = value != "floats", .compress = value == "meshopt"};
    return absl::OkStatus();
  }
  return bad_query_part(part, absl::StrCat("is nothing that tiles have; there are: ", kParts,
                                           ". They are the same for all cameras, in the order of the session's seed"));
}

/// Percent-encoded, as far as a query needs it.
std::string encoded(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const bool stays =
        absl::ascii_isalnum(static_cast<unsigned char>(c)) || std::string_view("-._~:=,*/()").find(c) != std::string_view::npos;
    stays ? out.push_back(c) : absl::StrAppend(&out, "%", absl::Hex(static_cast<unsigned char>(c), absl::kZeroPad2));
  }
  return out;
}

}  // namespace

absl::StatusOr<TilesetTerms> read_tileset_query(const WebResource::Query& query) {
  PointsTerms points;
  TilesetTerms terms;
  for (const Part& part : query) {
    if (absl::Status status = read_part(part, points, terms); !status.ok()) return status;
  }
  terms.sample = std::move(points.sample);
  terms.sample.set_sampler(v1::SAMPLER_PROGRESSIVE);
  terms.sample.add_attributes(v1::POINT_ATTRIBUTE_RANK);
  terms.sample.mutable_encoding()->mutable_raw();
  return terms;
}

absl::StatusOr<std::string> tileset_text(const WebResource::Query& query, std::uint64_t points) {
  std::string densities;
  bool is_z_up = false;
  std::string glb = "meshopt";
  for (const auto& [name, value] : query) {
    if (name == "density") absl::StrAppend(&densities, "&density=", encoded(value));
    if (name == "up") is_z_up = value == "z";
    if (name == "glb") glb = value;
  }
  std::string text =
      absl::StrCat("n=", points, densities, is_z_up ? "&up=z" : "", glb == "meshopt" ? "" : absl::StrCat("&glb=", glb));
  if (text.size() <= kMostText) return text;
  return absl::InvalidArgumentError(absl::StrCat("query: density: its terms have ", densities.size(),
                                                 " bytes; tiles, whose addresses have them, take about ", kMostText));
}

std::string TilesetAddress::part() const { return absl::StrCat(digest, ".", absl::WebSafeBase64Escape(text)); }

absl::Status no_such_tileset() {
  return absl::NotFoundError("there are no tiles of this name; tileset.json says where the tiles are");
}

absl::StatusOr<TilesetAddress> read_tileset_address(std::string_view part) {
  TilesetAddress address{.digest = std::string(part.substr(0, kDigestSize))};
  const auto is_digit = [](unsigned char c) { return absl::ascii_isdigit(c) || (c >= 'a' && c <= 'f'); };
  if (part.size() <= kDigestSize + 1 || part[kDigestSize] != '.' ||
      !std::all_of(address.digest.begin(), address.digest.end(), is_digit) || part.size() > kDigestSize + 1 + 2 * kMostText) {
    return no_such_tileset();
  }
  const std::string_view escaped = part.substr(kDigestSize + 1);
  if (!absl::WebSafeBase64Unescape(absl::string_view(escaped.data(), escaped.size()), &address.text)) return no_such_tileset();
  // Only what this server writes: nobody has the same tiles made under many names.
  return address.part() == part ? absl::StatusOr<TilesetAddress>(std::move(address)) : no_such_tileset();
}

}  // namespace curvecast::server
