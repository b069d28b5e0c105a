#include "core/codec/symbol_writer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/base/simd.h"
#include "core/codec/bit_writer.h"

namespace curvecast {
namespace {

constexpr int kMaxRawBits = 18;
constexpr std::size_t kTags = 32;
constexpr std::uint8_t kTagged = 0, kRaw = 1;
constexpr int kTagPrecisionBits = 12;

// Neighbours are often equal; each counts in a row of its own, so that no count waits for the one before.
constexpr std::size_t kRows = 4;
constexpr std::size_t kMaxRowLength = std::size_t{1} << 12;  // all rows together stay in the nearest cache

struct Census {
  std::array<std::uint32_t, kTags> tags{};  // points by the length of their numbers in bits, 1 .. 31
  std::vector<std::uint32_t> symbols;       // numbers by value, up to the largest; empty: too large for the raw way
};

CURVECAST_WIDE std::uint32_t bits_of_all(const std::uint32_t* symbols, std::size_t n) {
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < n; ++i) bits |= symbols[i];
  return bits;
}

template <int components>
std::uint32_t tag_of(const std::uint32_t* symbols) {
  std::uint32_t bits = 1;
  for (int c = 0; c < components; ++c) bits |= symbols[c];
  return static_cast<std::uint32_t>(std::bit_width(bits));
}

/// Counts into row after row of `row_length` each, or into one alone where that is 0.
template <int components>
void count(std::span<const std::uint32_t> symbols, std::size_t row_length, bool counts_symbols, std::uint32_t* counts,
           std::array<std::uint32_t, kTags>& tags) {
  std::array<std::array<std::uint32_t, kTags>, kRows> tag_rows{};
  const std::size_t points = symbols.size() / components;
  const std::uint32_t* next = symbols.data();
  const auto count_point = [&](std::size_t row) {
    ++tag_rows[row][tag_of<components>(next)];
    for (std::size_t c = 0; c < components && counts_symbols; ++c) {
      ++counts[(row * components + c) % kRows * row_length + next[c]];
    }
    next += components;
  };
  std::size_t i = 0;
  for (; i + kRows <= points; i += kRows) {
    for (std::size_t row = 0; row < kRows; ++row) count_point(row);
  }
  for (; i < points; ++i) count_point(0);
  for (const auto& row : tag_rows) {
    for (std::size_t tag = 0; tag < kTags; ++tag) tags[tag] += row[tag];
  }
}

Census take_census(std::span<const std::uint32_t> symbols, int components) {
  const int bits = std::bit_width(bits_of_all(symbols.data(), symbols.size()) | 1);
  const bool counts_symbols = bits <= kMaxRawBits;
  const std::size_t length = counts_symbols ? std::size_t{1} << bits : 0;
  const std::size_t row_length = length <= kMaxRowLength ? length : 0;
  Census census;
  census.symbols.resize(row_length > 0 ? kRows * length : length);
  const auto counter = components == 1 ? count<1> : components == 2 ? count<2> : count<3>;
  counter(symbols, row_length, counts_symbols, census.symbols.data(), census.tags);
  for (std::size_t row = 1; row < kRows && row_length > 0; ++row) {
    for (std::size_t i = 0; i < length; ++i) census.symbols[i] += census.symbols[row * length + i];
  }
  census.symbols.resize(length);
  while (!census.symbols.empty() && census.symbols.back() == 0) census.symbols.pop_back();
  return census;
}

struct Estimate {
  std::int64_t bits;  // of an entropy code
  std::int64_t distinct;
};

/// As Draco estimates it, to the bit: both take the same way.
Estimate estimate(std::span<const std::uint32_t> counts, std::size_t all) {
  // Most symbols are rare, and most logarithms those of few numbers.
  constexpr std::uint32_t kRare = 64;
  std::array<double, kRare> of_rare{};
  const auto bits_of = [&](std::uint32_t n) { return n * std::log2(static_cast<double>(n) / static_cast<double>(all)); };
  for (std::uint32_t n = 1; n < kRare; ++n) of_rare[n] = bits_of(n);
  double bits = 0;
  std::int64_t distinct = 0;
  for (const std::uint32_t n : counts) {
    if (n == 0) continue;
    bits += n < kRare ? of_rare[n] : bits_of(n);
    ++distinct;
  }
  return {static_cast<std::int64_t>(-bits), distinct};
}

std::int64_t table_bits(std::int64_t largest, std::int64_t distinct) { return 8 * (2 * distinct + (largest - distinct) / 64); }

std::vector<std::uint32_t> tags_of(std::span<const std::uint32_t> symbols, int components) {
  std::vector<std::uint32_t> tags(symbols.size() / static_cast<std::size_t>(components));
  const auto tag = components == 1 ? tag_of<1> : components == 2 ? tag_of<2> : tag_of<3>;
  for (std::size_t i = 0; i < tags.size(); ++i) tags[i] = tag(&symbols[i * static_cast<std::size_t>(components)]);
  return tags;
}

}  // namespace

SymbolWriter::SymbolWriter(std::span<const std::uint32_t> symbols, int components) : symbols_(symbols), components_(components) {
  const Census census = take_census(symbols, components);
  bool is_raw = !census.symbols.empty();
  if (is_raw) {
    const Estimate tags = estimate(census.tags, symbols.size() / static_cast<std::size_t>(components));
    std::int64_t tagged_bits = tags.bits + table_bits(tags.distinct, tags.distinct);
    for (std::size_t tag = 0; tag < kTags; ++tag) tagged_bits += static_cast<std::int64_t>(tag * census.tags[tag]) * components;
    const Estimate raw = estimate(census.symbols, symbols.size());
    const int distinct_bits = std::bit_width(static_cast<std::uint64_t>(raw.distinct));
    is_raw = raw.bits + table_bits(static_cast<std::int64_t>(census.symbols.size()) - 1, raw.distinct) <= tagged_bits &&
             distinct_bits <= kMaxRawBits;
    // One less, as Draco does at its usual speed, makes for a coarser and shorter table.
    table_bits_ = std::max(distinct_bits - 1, 1);
  }
  if (is_raw) {
    table_.emplace(census.symbols, std::clamp(3 * table_bits_ / 2, 12, 20));
    run_ = {.table = &*table_, .symbols = symbols_};
  } else {
    tags_ = tags_of(symbols, components);
    std::size_t n = kTags;
    while (census.tags[n - 1] == 0) --n;
    table_.emplace(std::span(census.tags).first(n), kTagPrecisionBits);
    run_ = {.table = &*table_, .symbols = tags_};
  }
}

void SymbolWriter::write(ByteWriter& bytes) const {
  bytes.put(tags_.empty() ? kRaw : kTagged);
  if (tags_.empty()) bytes.put_byte(table_bits_);
  table_->write(bytes);
  bytes.put_varint(run_.size);
  bytes.put_bytes(run_.code());
  BitWriter bits(bytes);
  const auto components = static_cast<std::size_t>(components_);
  for (std::size_t i = 0; i < tags_.size(); ++i) {
    for (std::size_t c = 0; c < components; ++c) bits.put(symbols_[i * components + c], static_cast<int>(tags_[i]));
  }
  bits.finish();
}

}  // namespace curvecast
