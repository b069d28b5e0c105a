// SPDX-License-Identifier: Apache-2.0
#include "proto/formats/spz.h"

#include <absl/strings/str_format.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "proto/formats/append_value.h"

namespace curvecast::formats {
namespace {

constexpr std::uint32_t kMagic = 0x5053474e;  // "NGSP"
constexpr std::uint32_t kVersion = 3;
constexpr int kMostFractionBits = 30;               // readers shift a 32-bit 1 by so much
constexpr double kLargestFixed = (1 << 23) - 1;     // of 24 bits
constexpr double kScaleSteps = 16, kScaleZero = 10;  // bytes are 16 (ln(width) + 10)
constexpr double kColourScale = 0.15;               // of the coefficients on the constant harmonic
constexpr int kGzip = 16 + MAX_WBITS;

absl::StatusOr<std::string> gzip(const std::string& bytes) {
  z_stream stream{};
  if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kGzip, 9, Z_DEFAULT_STRATEGY) != Z_OK) {
    return absl::ResourceExhaustedError("not enough memory to compress splats");
  }
  std::string out;
  constexpr std::size_t kStep = std::size_t{1} << 20;
  std::size_t taken = 0;
  int state = Z_OK;
  while (state == Z_OK || state == Z_BUF_ERROR) {
    const std::size_t size = std::min<std::size_t>(bytes.size() - taken, std::numeric_limits<uInt>::max());
    // zlib does not write to what it reads.
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data() + taken));
    stream.avail_in = static_cast<uInt>(size);
    const std::size_t written = out.size();
    out.resize(written + kStep);
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + written);
    stream.avail_out = static_cast<uInt>(kStep);
    state = deflate(&stream, taken + size == bytes.size() ? Z_FINISH : Z_NO_FLUSH);
    taken += size - stream.avail_in;
    out.resize(out.size() - stream.avail_out);
  }
  deflateEnd(&stream);
  if (state != Z_STREAM_END) return absl::InternalError("splats cannot be compressed");
  return out;
}

double scale_steps(double width) { return std::round(kScaleSteps * (std::log(width) + kScaleZero)); }

std::uint8_t to_byte(double value) { return static_cast<std::uint8_t>(std::clamp(std::round(value), 0.0, 255.0)); }

/// The largest component is left out: it follows from the others, with its sign made positive.
std::uint32_t pack_rotation(const std::array<float, 4>& rotation) {
  constexpr double kLargest = 511;
  std::uint32_t largest = 0;
  for (std::uint32_t i = 1; i < 4; ++i) {
    if (std::abs(rotation[i]) > std::abs(rotation[largest])) largest = i;
  }
  std::uint32_t packed = largest;
  for (std::uint32_t i = 0; i < 4; ++i) {
    if (i == largest) continue;
    const std::uint32_t negative = (rotation[i] < 0) != (rotation[largest] < 0) ? 1 : 0;
    const double share = std::min(std::abs(double{rotation[i]}) * std::sqrt(2.0), 1.0);
    packed = packed << 10 | negative << 9 | static_cast<std::uint32_t>(std::lround(kLargest * share));
  }
  return packed;
}

absl::Status check_widths(const Splats& splats) {
  const auto [least, most] = std::minmax_element(splats.widths.begin(), splats.widths.end());
  if (scale_steps(*most) >= 0 && scale_steps(*most) <= 255) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrFormat(
      "splats of %g to %g units do not fit into .spz, whose splats are of %.2g to %.3g units: scale the mesh, or write .ply or .glb",
      *least, *most, std::exp(-kScaleZero), std::exp(255 / kScaleSteps - kScaleZero)));
}

/// Returns how many bits of a position are a fraction.
absl::StatusOr<int> fraction_bits(const Splats& splats) {
  double farthest = 0;
  for (const std::array<float, 3>& position : splats.positions) {
    for (const float coordinate : position) farthest = std::max(farthest, std::abs(double{coordinate}));
  }
  if (farthest > kLargestFixed) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "points %g units from the origin do not fit into .spz, which reaches as far as %g: scale the mesh, or write .ply or .glb",
        farthest, kLargestFixed));
  }
  int bits = 0;
  while (bits < kMostFractionBits && farthest * std::ldexp(1.0, bits + 1) <= kLargestFixed) ++bits;
  return bits;
}

}  // namespace

absl::StatusOr<std::string> make_spz(const PointColumns& columns) {
  const absl::StatusOr<Splats> splats = make_splats(columns);
  if (!splats.ok()) return splats.status();
  if (splats->size() > 0) {
    if (absl::Status status = check_widths(*splats); !status.ok()) return status;
  }
  const absl::StatusOr<int> bits = fraction_bits(*splats);
  if (!bits.ok()) return bits.status();
  std::string out;
  append_value(out, kMagic);
  append_value(out, kVersion);
  append_value(out, static_cast<std::uint32_t>(splats->size()));
  append_value(out, std::uint8_t{0});  // degree of the spherical harmonics
  append_value(out, static_cast<std::uint8_t>(*bits));
  append_value(out, std::uint16_t{0});  // flags, reserved
  for (const std::array<float, 3>& position : splats->positions) {
    for (const float coordinate : position) {
      const auto fixed = static_cast<std::int32_t>(std::lround(std::ldexp(double{coordinate}, *bits)));
      for (int byte = 0; byte < 3; ++byte) append_value(out, static_cast<std::uint8_t>(fixed >> 8 * byte));
    }
  }
  out.append(splats->size(), static_cast<char>(to_byte(255.0 * kSplatOpacity)));
  for (const std::array<std::uint8_t, 3>& colour : splats->colours) {
    for (const std::uint8_t channel : colour) {
      append_value(out, to_byte(255 * (kColourScale * double{harmonic_of(channel)} + 0.5)));
    }
  }
  for (const float width : splats->widths) {
    const std::uint8_t along = to_byte(scale_steps(width));
    append_value(out, std::array<std::uint8_t, 3>{along, along, to_byte(scale_steps(double{width} * double{kSplatThickness}))});
  }
  for (const std::array<float, 4>& rotation : splats->rotations) append_value(out, pack_rotation(rotation));
  return gzip(out);
}

}  // namespace curvecast::formats
