#include "core/codec/draco_codec.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/codec/byte_writer.h"
#include "core/codec/delta_symbols.h"
#include "core/codec/lattice.h"
#include "core/codec/octahedral.h"
#include "core/codec/symbol_writer.h"
#include "core/sample/radius_ladder.h"

namespace curvecast {
namespace {

Lattice lattice_of(const DracoOptions& options) {
  return {.low = options.box_min.cast<float>(),
          .size = static_cast<float>(options.box_size),
          .bits = options.position_bits,
          .is_centred = options.is_centred};
}

absl::Status check(std::size_t count, const DracoOptions& options) {
  if (count == 0) return absl::InvalidArgumentError("there are no points to encode");
  if (options.position_bits < 1 || options.position_bits > 30) {
    return absl::InvalidArgumentError(absl::StrFormat("position_bits = %d; it must lie in 1 .. 30", options.position_bits));
  }
  if (options.normal_bits < 2 || options.normal_bits > 30) {
    return absl::InvalidArgumentError(absl::StrFormat("normal_bits = %d; it must lie in 2 .. 30", options.normal_bits));
  }
  return check_lattice(lattice_of(options));
}

// A rung is four codes of 255 for 2^(255 / 8).
constexpr int kHighestCode = 255, kCodesPerRung = 4, kCodesPerOctave = kCodesPerRung * RadiusLadder::kRungsPerOctave;

void radius_codes(std::span<const float> radii, float largest, std::span<std::int32_t> codes) {
  const RadiusLadder ladder(largest);
  for (std::size_t i = 0; i < radii.size(); ++i) codes[i] = kHighestCode - kCodesPerRung * ladder.rung(radii[i]);
}

void without_alpha(std::span<const Rgba8> colours, std::span<std::int32_t> rgb) {
  for (std::size_t i = 0; i < colours.size(); ++i) {
    const Rgba8& c = colours[i];
    rgb[3 * i] = c.r, rgb[3 * i + 1] = c.g, rgb[3 * i + 2] = c.b;
  }
}

ValueRange differences(std::span<const std::int32_t> values, int components, std::span<std::uint32_t> symbols) {
  const ValueRange range = range_of(values);
  delta_symbols(values, components, range, symbols);
  return range;
}

// Codes of Draco's bitstream, version 2.3.
enum class Transform : std::uint8_t { kWrap = 1, kOctahedral = 3 };
enum class Type : std::uint8_t { kPosition = 0, kNormal = 1, kColour = 2, kGeneric = 4 };
enum class DataType : std::uint8_t { kByte = 2, kFloat = 9 };
enum class Way : std::uint8_t { kInteger = 1, kQuantised = 2, kNormal = 3 };

struct Attribute {
  Type type;
  DataType data_type;
  int components;
  Way way;
};

void write_header(ByteWriter& bytes, std::size_t count, std::span<const Attribute> attributes) {
  constexpr std::uint8_t kHead[] = {'D', 'R', 'A', 'C', 'O', 2, 3, /*point cloud*/ 0, /*sequential*/ 0, /*no metadata*/ 0, 0};
  bytes.put(kHead);
  bytes.put(static_cast<std::uint32_t>(count));
  bytes.put_byte(1);  // group of attributes
  bytes.put_varint(attributes.size());
  for (std::size_t i = 0; i < attributes.size(); ++i) {
    bytes.put(attributes[i].type);
    bytes.put(attributes[i].data_type);
    bytes.put_byte(attributes[i].components);
    bytes.put_byte(0);  // not normalised
    bytes.put_varint(i);
  }
  for (const Attribute& attribute : attributes) bytes.put(attribute.way);
}

/// Differences to the point before, and the two numbers by which they are undone.
void write_symbols(ByteWriter& bytes, Transform transform, const SymbolWriter& symbols, std::int32_t first, std::int32_t second) {
  bytes.put_byte(0);  // predicted to be as before
  bytes.put(transform);
  bytes.put_byte(1);  // with an entropy code
  symbols.write(bytes);
  bytes.put(first);
  bytes.put(second);
}

}  // namespace

absl::StatusOr<std::string> encode_draco(const PointSet& points, const DracoOptions& options, float* radius_min,
                                         float* radius_max) {
  return encode_draco(points, 0, points.size(), options, radius_min, radius_max);
}

absl::StatusOr<std::string> encode_draco(const PointSet& points, std::size_t begin, std::size_t count,
                                         const DracoOptions& options, float* radius_min, float* radius_max) {
  if (absl::Status status = check(count, options); !status.ok()) return status;
  const auto part = [&](const auto& column) { return std::span(column).subspan(begin, count); };
  const std::span<const float> radii = part(points.radii);
  const bool has_colours = !points.colours.empty();
  // The values of one attribute after the other, and the symbols of all.
  const std::size_t symbols_of_point = 6 + (has_colours ? 3 : 0);
  const auto value_memory = std::make_unique_for_overwrite<std::int32_t[]>(3 * count);
  const auto symbol_memory = std::make_unique_for_overwrite<std::uint32_t[]>(symbols_of_point * count);
  const std::span values(value_memory.get(), 3 * count), codes = values.first(count);
  const std::span symbols(symbol_memory.get(), symbols_of_point * count);
  const auto position_symbols = symbols.first(3 * count), normal_symbols = symbols.subspan(3 * count, 2 * count),
             radius_symbols = symbols.subspan(5 * count, count), colour_symbols = symbols.subspan(6 * count);

  const Lattice lattice = lattice_of(options);
  if (absl::Status status = to_lattice(lattice, part(points.positions), values); !status.ok()) return status;
  const ValueRange position_range = differences(values, 3, position_symbols);
  const OctahedralLattice octahedron(options.normal_bits);
  octahedral_symbols(octahedron, part(points.normals), normal_symbols);
  *radius_max = options.radius_max > 0 ? static_cast<float>(options.radius_max) : *std::max_element(radii.begin(), radii.end());
  *radius_min = *radius_max * std::exp2(-static_cast<float>(kHighestCode) / kCodesPerOctave);
  radius_codes(radii, *radius_max, codes);
  const ValueRange radius_range = differences(codes, 1, radius_symbols);
  ValueRange colour_range{};
  if (has_colours) {
    without_alpha(part(points.colours), values);
    colour_range = differences(values, 3, colour_symbols);
  }

  SymbolWriter position(position_symbols, 3), normal(normal_symbols, 2), radius(radius_symbols, 1);
  std::optional<SymbolWriter> colour;
  std::vector<RansRun*> runs = {&position.run(), &normal.run(), &radius.run()};
  // The two longest side by side.
  if (has_colours) runs.insert(runs.begin() + 1, &colour.emplace(colour_symbols, 3).run());
  code_runs(runs);

  ByteWriter bytes;
  std::vector<Attribute> attributes = {{Type::kPosition, DataType::kFloat, 3, Way::kQuantised},
                                       {Type::kNormal, DataType::kFloat, 3, Way::kNormal},
                                       {Type::kGeneric, DataType::kByte, 1, Way::kInteger}};
  if (has_colours) attributes.push_back({Type::kColour, DataType::kByte, 3, Way::kInteger});
  write_header(bytes, count, attributes);
  write_symbols(bytes, Transform::kWrap, position, position_range.least, position_range.most);
  write_symbols(bytes, Transform::kOctahedral, normal, octahedron.modulus, octahedron.center);
  write_symbols(bytes, Transform::kWrap, radius, radius_range.least, radius_range.most);
  if (has_colours) write_symbols(bytes, Transform::kWrap, *colour, colour_range.least, colour_range.most);
  for (const float x : lattice.zero()) bytes.put(x);
  bytes.put(lattice.size);
  bytes.put_byte(lattice.bits);
  bytes.put_byte(options.normal_bits);
  return std::move(bytes).take();
}

}  // namespace curvecast
