// SPDX-License-Identifier: Apache-2.0
#include "client/lib/draco/draco_reader.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "client/lib/draco/symbol_values.h"

namespace curvecast::client {
namespace {

// Draco's numbers for how attributes are stored, predicted and corrected.
constexpr std::uint8_t kStoredInteger = 1, kStoredQuantised = 2, kStoredNormal = 3;
constexpr std::int8_t kPredictDifference = 0, kCorrectWrapped = 1, kCorrectOctahedral = 3;

bool is_ours(const DracoAttribute& attribute) {
  switch (attribute.kind) {
    case DracoKind::kPosition:
    case DracoKind::kNormal:
      return attribute.type == kDracoFloat && attribute.components == 3;
    case DracoKind::kGeneric:
      return attribute.type == kDracoUint8 && attribute.components == 1;
    case DracoKind::kColour:
      return attribute.type == kDracoUint8 && (attribute.components == 3 || attribute.components == 4);
  }
  return false;
}

std::uint8_t stored_as(DracoKind kind) {
  return kind == DracoKind::kPosition ? kStoredQuantised : kind == DracoKind::kNormal ? kStoredNormal : kStoredInteger;
}

bool is_ours(const DracoHeaderInfo& header) {
  const auto is_first = [&](const DracoAttribute& a) { return header.find(a.kind) == &a; };
  return header.sequential && header.find(DracoKind::kPosition) != nullptr &&
         std::all_of(header.attributes.begin(), header.attributes.end(),
                     [&](const DracoAttribute& a) { return is_ours(a) && is_first(a); });
}

}  // namespace

DracoReader::Source& DracoReader::source(DracoKind kind) {
  switch (kind) {
    case DracoKind::kPosition:
      return position_;
    case DracoKind::kNormal:
      return normal_;
    case DracoKind::kColour:
      return colour_;
    case DracoKind::kGeneric:
      break;
  }
  return radius_;
}

absl::StatusOr<bool> DracoReader::read(std::string_view bytes, const DracoHeaderInfo& header, RadiusRange radii,
                                       const PointColumns& to) {
  if (!is_ours(header)) return false;
  absl::StatusOr<bool> understood = read_sources(bytes, header);
  if (!understood.ok() || !*understood) return understood;
  if (absl::Status status = read_values(header.points, radii, to); !status.ok()) return status;
  return true;
}

absl::StatusOr<bool> DracoReader::read_sources(std::string_view bytes, const DracoHeaderInfo& header) {
  ByteReader reader(bytes.substr(header.size));
  for (Source* source : {&position_, &normal_, &radius_, &colour_}) {
    source->present = false;
    source->min = source->max = 0;
  }
  bool ours = true;
  for (const DracoAttribute& attribute : header.attributes) {
    source(attribute.kind).present = true;
    source(attribute.kind).components = attribute.kind == DracoKind::kNormal ? 2 : attribute.components;
    std::uint8_t stored = 0;
    if (!reader.read(stored)) return broken_draco("it ends before its values");
    ours = ours && stored == stored_as(attribute.kind);
  }
  if (!ours) return false;
  for (const DracoAttribute& attribute : header.attributes) {
    absl::StatusOr<bool> understood = read_symbols(reader, attribute.kind, header.points);
    if (!understood.ok() || !*understood) return understood;
  }
  for (const DracoAttribute& attribute : header.attributes) {
    if (absl::Status status = read_quantisation(reader, attribute.kind); !status.ok()) return status;
  }
  return true;
}

absl::StatusOr<bool> DracoReader::read_symbols(ByteReader& bytes, DracoKind kind, std::size_t points) {
  const bool octahedral = kind == DracoKind::kNormal;
  std::int8_t prediction = 0, correction = 0;
  if (!bytes.read(prediction)) return broken_draco("it ends before its values");
  if (prediction != kPredictDifference) return false;
  if (!bytes.read(correction)) return broken_draco("it ends before its values");
  if (correction != (octahedral ? kCorrectOctahedral : kCorrectWrapped)) return false;
  Source& from = source(kind);
  if (absl::Status status = from.symbols.open(bytes, points, from.components); !status.ok()) return status;
  if (!bytes.read(from.min) || !bytes.read(from.max)) return broken_draco("it ends within the bounds of its values");
  if (octahedral) {
    const auto largest = static_cast<std::uint32_t>(from.min);  // 2^bits - 1; then half of that
    from.bits = std::bit_width(largest);
    if (from.bits < 2 || from.bits > 30 || largest % 2 == 0) return broken_draco("its normals have impossible bounds");
  } else if (from.min > from.max || static_cast<std::int64_t>(from.max) - from.min >= std::numeric_limits<std::int32_t>::max()) {
    return broken_draco("its values have impossible bounds");
  }
  return true;
}

absl::Status DracoReader::read_quantisation(ByteReader& bytes, DracoKind kind) {
  Source& from = source(kind);
  std::uint8_t bits = 0;
  if (kind == DracoKind::kPosition) {
    if (!bytes.read(from.low) || !bytes.read(from.range) || !bytes.read(bits)) return broken_draco("it ends within its lattice");
    if (bits < 1 || bits > 30) return broken_draco("its positions have impossible bits");
    from.bits = bits;
  } else if (kind == DracoKind::kNormal) {
    if (!bytes.read(bits)) return broken_draco("it ends within its lattice");
    if (bits != from.bits) return broken_draco("its normals have two different numbers of bits");
  }
  return absl::OkStatus();
}

absl::Status DracoReader::read_values(std::size_t points, RadiusRange radii, const PointColumns& to) {
  if (radius_.present && radii.valid() && radii != range_) {
    radii_ = radius_table(radii);
    range_ = radii;
  }
  const float delta = position_.range / static_cast<float>((1 << position_.bits) - 1);
  WrappedValues positions(position_.min, position_.max);
  OctahedralValues normals(normal_.present ? normal_.bits : 2);
  WrappedValues codes(radius_.min, radius_.max), colours(colour_.min, colour_.max);
  std::array<float, kPart> unwanted;
  for (std::size_t begin = 0; begin < points; begin += kPart) {
    const std::size_t count = std::min(kPart, points - begin);
    read_part(count);
    positions.to_places(position_.part.data(), delta, position_.low, to.positions.subspan(begin, count));
    if (normal_.present) normals.to_normals(normal_.part.data(), to.normals.subspan(begin, count));
    if (radius_.present) {
      codes.to_radii(radius_.part.data(), radii_,
                     radii.valid() ? to.radii.subspan(begin, count) : std::span(unwanted).first(count));
    }
    if (colour_.present) colours.to_colours(colour_.part.data(), colour_.components, to.colours.subspan(begin, count));
  }
  for (Source* from : {&position_, &normal_, &radius_, &colour_}) {
    if (from->present && !from->symbols.had_enough()) return broken_draco("its symbols end too early");
  }
  if (!positions.all_within() || !normals.all_within() || !codes.all_within() || !colours.all_within()) {
    return broken_draco("its values leave the bounds that it states");
  }
  // Between two finite places all are.
  for (const std::int32_t end : {position_.min, position_.max}) {
    for (const float low : position_.low) {
      if (!std::isfinite(static_cast<float>(end) * delta + low)) return check_finite(to);
    }
  }
  return absl::OkStatus();
}

void DracoReader::read_part(std::size_t count) {
  RansReader *position = position_.symbols.entropy(), *normal = normal_.symbols.entropy(), *radius = radius_.symbols.entropy();
  const bool together = normal_.present && radius_.present && position != nullptr && normal != nullptr && radius != nullptr;
  if (together) {
    RansReader::read_together({position, normal, radius}, count,
                              {position_.part.data(), normal_.part.data(), radius_.part.data()});
  }
  for (Source* from : {&position_, &normal_, &radius_, &colour_}) {
    if (from->present && !(together && from != &colour_)) from->symbols.read(count, from->part.data());
  }
}

}  // namespace curvecast::client
