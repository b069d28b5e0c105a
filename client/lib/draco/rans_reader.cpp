// SPDX-License-Identifier: Apache-2.0
#include "client/lib/draco/rans_reader.h"

#include <algorithm>

#include "client/lib/draco/draco_header.h"

namespace curvecast::client {
namespace {

constexpr std::uint32_t kZeroRun = 3;  // of the low two bits of a table's byte; other values: how many bytes follow
constexpr int kNarrowBits = 12;        // an entry of four bytes: frequency - 1, offset, slot
constexpr std::size_t kMostNarrowSlots = 256;
constexpr int kMostWideBits = 15;  // beyond, a table would be larger than what is read with it
constexpr int kIndexBits = 12;

}  // namespace

/// A stream held in registers. Every step appends bytes to the state until it is at least four times the sum of the frequencies,
/// as long as there are any, and then takes the symbol of its low bits out.
struct RansReader::Stream {
  explicit Stream(const RansReader& reader) : state(reader.state_), begin(reader.begin_), end(reader.end_) {}

  /// At most `kMost` bytes, which is enough for precisions up to 8 kMost.
  template <int kMost>
  void refill(std::uint32_t least) {
    if (end - begin < kMost) [[unlikely]] {
      while (state < least && end > begin) state = state << 8 | *--end;
      return;
    }
    // How many it takes is random: a branch would be foreseen wrongly too often. Four bytes can always be read, for a table and
    // the stream's length come before it.
    std::uint32_t next_bytes = 0;
    std::memcpy(&next_bytes, end - sizeof next_bytes, sizeof next_bytes);
    int unused = 0;
    for (int i = 0; i < kMost; ++i) unused += state >= least >> 8 * i;
    const std::uint64_t appended = std::uint64_t{state} << 8 * kMost | next_bytes >> (32 - 8 * kMost);
    state = static_cast<std::uint32_t>(appended >> 8 * unused);
    end -= kMost - unused;
  }

  std::uint32_t state;
  const std::uint8_t *begin, *end;
};

struct RansReader::NarrowStream : Stream {
  explicit NarrowStream(const RansReader& reader) : Stream(reader), table(reader.narrow_.data()), slots(reader.slots_.data()) {}

  std::uint32_t next() {
    constexpr std::uint32_t kLow = (1U << kNarrowBits) - 1;
    refill<2>(4U << kNarrowBits);
    const std::uint32_t entry = table[state & kLow], high = state >> kNarrowBits;
    state = high * (entry & kLow) + (high + (entry >> kNarrowBits & kLow));
    return slots[entry >> 2 * kNarrowBits].symbol;
  }

  const std::uint32_t* table;
  const Slot* slots;
};

struct RansReader::WideStream : Stream {
  explicit WideStream(const RansReader& reader) : Stream(reader), table(reader.wide_.data()), precision(reader.precision_) {}

  std::uint32_t next() {
    refill<2>(4U << precision);
    const Entry entry = table[state & ((1U << precision) - 1)];
    state = (state >> precision) * entry.frequency + entry.offset;
    return entry.symbol;
  }

  const Entry* table;
  int precision;
};

struct RansReader::SearchedStream : Stream {
  explicit SearchedStream(const RansReader& reader)
      : Stream(reader), slots(reader.slots_.data()), first(reader.first_.data()), precision(reader.precision_) {}

  std::uint32_t next() {
    refill<3>(4U << precision);
    const std::uint32_t low = state & ((1U << precision) - 1);
    const Slot* slot = slots + first[low >> (precision - kIndexBits)];
    while (slot[1].start <= low) ++slot;
    state = (state >> precision) * (slot[1].start - slot[0].start) + (low - slot[0].start);
    return slot->symbol;
  }

  const Slot* slots;
  const std::uint32_t* first;
  int precision;
};

absl::Status RansReader::open(ByteReader& bytes, int precision_bits) {
  precision_ = precision_bits;
  if (absl::Status status = read_table(bytes); !status.ok()) return status;
  narrow_.clear();
  wide_.clear();
  if (precision_ == kNarrowBits && slots_.size() - 1 <= kMostNarrowSlots) {
    fill_narrow();
  } else if (precision_ <= kMostWideBits) {
    fill_wide();
  } else {
    index_slots();
  }
  return start(bytes);
}

absl::Status RansReader::read_table(ByteReader& bytes) {
  std::uint32_t symbols = 0, sum = 0;
  if (!bytes.read_varint(symbols) || symbols == 0) return broken_draco("it lacks a table of symbols");
  slots_.clear();
  for (std::uint32_t symbol = 0; symbol < symbols; ++symbol) {
    std::uint8_t byte = 0;
    if (!bytes.read(byte)) return broken_draco("it ends within a table of symbols");
    const std::uint32_t more = byte & 3;
    std::uint32_t frequency = byte >> 2;
    if (more == kZeroRun) {
      if (frequency >= symbols - symbol) return broken_draco("a table of symbols is longer than it claims");
      symbol += frequency;
      continue;
    }
    for (std::uint32_t i = 0; i < more; ++i) {
      if (!bytes.read(byte)) return broken_draco("it ends within a table of symbols");
      frequency |= static_cast<std::uint32_t>(byte) << (8 * i + 6);
    }
    if (frequency > (1U << precision_) - sum) return broken_draco("the frequencies of its symbols are too large");
    if (frequency > 0) slots_.push_back({sum, symbol});
    sum += frequency;
  }
  if (sum != 1U << precision_) return broken_draco("the frequencies of its symbols are too small");
  slots_.push_back({sum, 0});
  return absl::OkStatus();
}

void RansReader::fill_narrow() {
  narrow_.resize(std::size_t{1} << precision_);
  for (std::size_t slot = 0; slot + 1 < slots_.size(); ++slot) {
    const std::uint32_t start = slots_[slot].start, frequency = slots_[slot + 1].start - start;
    const std::uint32_t first = static_cast<std::uint32_t>(slot) << 2 * kNarrowBits | (frequency - 1);
    for (std::uint32_t i = 0; i < frequency; ++i) narrow_[start + i] = first | i << kNarrowBits;
  }
}

void RansReader::fill_wide() {
  wide_.resize(std::size_t{1} << precision_);
  for (std::size_t slot = 0; slot + 1 < slots_.size(); ++slot) {
    const auto [start, symbol] = slots_[slot];
    const std::uint32_t frequency = slots_[slot + 1].start - start;
    for (std::uint32_t i = 0; i < frequency; ++i) {
      wide_[start + i] = {static_cast<std::uint16_t>(frequency), static_cast<std::uint16_t>(i), symbol};
    }
  }
}

void RansReader::index_slots() {
  first_.resize(std::size_t{1} << kIndexBits);
  std::uint32_t slot = 0;
  for (std::uint32_t i = 0; i < first_.size(); ++i) {
    while (slots_[slot + 1].start <= i << (precision_ - kIndexBits)) ++slot;
    first_[i] = slot;
  }
}

absl::Status RansReader::start(ByteReader& bytes) {
  std::uint64_t size = 0;
  std::span<const std::uint8_t> stream;
  if (!bytes.read_varint(size) || !bytes.take(size, stream) || size == 0) return broken_draco("it ends within its symbols");
  // The last byte says in two bits how many more belong to the first state, which is stored less its smallest value.
  const std::size_t state_bytes = 1 + (stream.back() >> 6);
  if (size < state_bytes) return broken_draco("it ends within its symbols");
  begin_ = stream.data();
  end_ = begin_ + size - state_bytes;
  std::uint32_t stored = 0;
  std::memcpy(&stored, end_, state_bytes);
  const std::uint32_t least = 4U << precision_;
  state_ = least + (stored & ((1U << (8 * state_bytes - 2)) - 1));
  if (state_ >= least << 8) return broken_draco("its symbols begin with an impossible state");
  return absl::OkStatus();
}

template <typename Function>
void RansReader::with_stream(Function&& function) const {
  if (!narrow_.empty()) {
    function(NarrowStream(*this));
  } else if (!wide_.empty()) {
    function(WideStream(*this));
  } else {
    function(SearchedStream(*this));
  }
}

void RansReader::read(std::size_t count, std::uint32_t* symbols) {
  with_stream([&](auto stream) {
    std::generate(symbols, symbols + count, [&] { return stream.next(); });
    put_back(stream);
  });
}

void RansReader::put_back(const Stream& stream) {
  state_ = stream.state;
  end_ = stream.end;
}

bool RansReader::had_enough() const {
  Stream stream(*this);
  stream.refill<3>(4U << precision_);
  return stream.state >= 4U << precision_;
}

void RansReader::read_together(const std::array<RansReader*, 3>& readers, std::size_t count,
                               const std::array<std::uint32_t*, 3>& symbols) {
  const auto read_all = [&](auto a, auto b, auto c) {
    auto [to_a, to_b, to_c] = symbols;
    for (std::size_t i = 0; i < count; ++i, to_a += 3, to_b += 2) {
      to_a[0] = a.next();
      to_b[0] = b.next();
      to_c[i] = c.next();
      to_a[1] = a.next();
      to_b[1] = b.next();
      to_a[2] = a.next();
    }
    readers[0]->put_back(a);
    readers[1]->put_back(b);
    readers[2]->put_back(c);
  };
  readers[0]->with_stream([&](const auto& a) {
    readers[1]->with_stream([&](const auto& b) { readers[2]->with_stream([&](const auto& c) { read_all(a, b, c); }); });
  });
}

}  // namespace curvecast::client
