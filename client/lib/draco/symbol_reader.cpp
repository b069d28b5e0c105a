// SPDX-License-Identifier: Apache-2.0
#include "client/lib/draco/symbol_reader.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "client/lib/draco/draco_header.h"

namespace curvecast::client {
namespace {

constexpr std::uint8_t kTaggedScheme = 0, kRawScheme = 1;
constexpr int kTagBits = 5;       // of the number of bits in a tag, for rans_precision()
constexpr int kMostRawBits = 18;  // of a symbol without a tag
constexpr std::uint32_t kMostTag = 32;

/// Bits of the sum of the frequencies of symbols of so many bits.
int rans_precision(int symbol_bits) { return std::clamp(3 * symbol_bits / 2, 12, 20); }

/// The `count` bits (0 .. 32) that begin at bit `begin`, counted from the lowest of the first byte; all within `bytes`.
std::uint32_t bits_at(std::span<const std::uint8_t> bytes, std::size_t begin, std::uint32_t count) {
  std::uint64_t word = 0;
  const std::size_t byte = begin / 8;
  if (byte + sizeof word <= bytes.size()) {
    std::memcpy(&word, bytes.data() + byte, sizeof word);
  } else if (byte < bytes.size()) {
    std::memcpy(&word, bytes.data() + byte, bytes.size() - byte);
  }
  return static_cast<std::uint32_t>(word >> begin % 8 & ((std::uint64_t{1} << count) - 1));
}

}  // namespace

absl::Status SymbolReader::open(ByteReader& bytes, std::size_t points, std::size_t components) {
  components_ = components;
  std::uint8_t compressed = 0, scheme = 0;
  if (!bytes.read(compressed)) return broken_draco("it ends before its values");
  if (compressed == 0) return open_bytes(bytes, points);
  if (!bytes.read(scheme)) return broken_draco("it ends before its values");
  if (scheme == kRawScheme) return open_entropy(bytes);
  if (scheme == kTaggedScheme) return open_tagged(bytes, points);
  return broken_draco("its symbols are coded in a way that Draco does not know");
}

absl::Status SymbolReader::open_bytes(ByteReader& bytes, std::size_t points) {
  coding_ = Coding::kBytes;
  std::uint8_t width = 0;
  if (!bytes.read(width) || width > sizeof(std::uint32_t)) return broken_draco("its values are of more than four bytes");
  width_ = width;
  if (!bytes.take(points * components_ * width_, data_)) return broken_draco("it ends within its values");
  return absl::OkStatus();
}

absl::Status SymbolReader::open_entropy(ByteReader& bytes) {
  coding_ = Coding::kEntropy;
  std::uint8_t bits = 0;
  if (!bytes.read(bits) || bits == 0 || bits > kMostRawBits) return broken_draco("its symbols are too long");
  return rans_.open(bytes, rans_precision(bits));
}

absl::Status SymbolReader::open_tagged(ByteReader& bytes, std::size_t points) {
  coding_ = Coding::kTagged;
  if (absl::Status status = rans_.open(bytes, rans_precision(kTagBits)); !status.ok()) return status;
  // Only all tags together say where the bits end.
  tags_.resize(points);
  std::uint64_t bits = 0;
  std::array<std::uint32_t, 256> part;
  for (std::size_t begin = 0; begin < points; begin += part.size()) {
    const std::size_t count = std::min(part.size(), points - begin);
    rans_.read(count, part.data());
    for (std::size_t i = 0; i < count; ++i) {
      if (part[i] > kMostTag) return broken_draco("it has values of more than 32 bits");
      tags_[begin + i] = static_cast<std::uint8_t>(part[i]);
      bits += components_ * part[i];
    }
  }
  if (!rans_.had_enough()) return broken_draco("its symbols end too early");
  if (!bytes.take((bits + 7) / 8, data_)) return broken_draco("it ends within its values");
  point_ = bit_ = 0;
  return absl::OkStatus();
}

void SymbolReader::read(std::size_t points, std::uint32_t* symbols) {
  switch (coding_) {
    case Coding::kBytes:
      return read_bytes(points, symbols);
    case Coding::kEntropy:
      return rans_.read(points * components_, symbols);
    case Coding::kTagged:
      return read_tagged(points, symbols);
  }
}

void SymbolReader::read_bytes(std::size_t points, std::uint32_t* symbols) {
  const std::size_t count = points * components_;
  for (std::size_t i = 0; i < count; ++i) {
    symbols[i] = 0;
    std::memcpy(&symbols[i], data_.data() + i * width_, width_);
  }
  data_ = data_.subspan(count * width_);
}

void SymbolReader::read_tagged(std::size_t points, std::uint32_t* symbols) {
  for (std::size_t i = 0; i < points; ++i) {
    const std::uint32_t tag = tags_[point_++];
    for (std::size_t c = 0; c < components_; ++c, bit_ += tag) *symbols++ = bits_at(data_, bit_, tag);
  }
}

}  // namespace curvecast::client
