#include "client/lib/rans_reader.h"

#include <algorithm>

#include "client/lib/draco_header.h"

namespace curvecast::client {
namespace {

constexpr int kIndexBits = 12;
constexpr std::uint32_t kZeroRun = 3;  // of the low two bits of a table's byte; other values: how many bytes follow

}  // namespace

/// A stream held in registers. Every step appends bytes to the state until it is at least four times the sum of the frequencies,
/// as long as there are any, and then takes the symbol of its low bits out.
struct RansReader::Direct {
  explicit Direct(const RansReader& reader)
      : table(reader.table_.data()),
        state(reader.state_),
        begin(reader.begin_),
        end(reader.end_),
        precision(static_cast<std::uint32_t>(reader.precision_)),
        least(4U << reader.precision_) {}

  void refill() {
    // Mostly none or one, which no branch predictor knows; so that byte is taken without a jump. The byte before the stream can
    // always be read: it is of the stream's length.
    const std::uint32_t longer = state << 8 | end[-1];
    const bool takes = state < (end > begin ? least : 0);
    state = takes ? longer : state;
    end -= takes ? 1 : 0;
    while (state < least && end > begin) [[unlikely]] {
        state = state << 8 | *--end;
      }
  }

  std::uint32_t next() {
    refill();
    const Entry entry = table[state & ((1U << precision) - 1)];
    state = (state >> precision) * entry.frequency + entry.offset;
    return entry.symbol;
  }

  void put_back(RansReader& reader) const {
    reader.state_ = state;
    reader.end_ = end;
  }

  const Entry* table;
  std::uint32_t state;
  const std::uint8_t *begin, *end;
  std::uint32_t precision, least;
};

/// The same for precisions whose table would be larger than what is read with it.
struct RansReader::Searching : Direct {
  explicit Searching(const RansReader& reader)
      : Direct(reader), slots(reader.slots_.data()), first(reader.first_.data()), shift(precision - kIndexBits) {}

  std::uint32_t next() {
    refill();
    const std::uint32_t low = state & ((1U << precision) - 1);
    const Slot* slot = slots + first[low >> shift];
    while (slot[1].start <= low) ++slot;
    state = (state >> precision) * (slot[1].start - slot[0].start) + (low - slot[0].start);
    return slot->symbol;
  }

  const Slot* slots;
  const std::uint32_t* first;
  std::uint32_t shift;
};

absl::Status RansReader::open(ByteReader& bytes, int precision_bits) {
  precision_ = precision_bits;
  if (absl::Status status = read_table(bytes); !status.ok()) return status;
  return start(bytes);
}

absl::Status RansReader::read_table(ByteReader& bytes) {
  std::uint32_t symbols = 0;
  if (!bytes.read_varint(symbols) || symbols == 0) return broken_draco("it lacks a table of symbols");
  sum_ = 0;
  table_.resize(is_direct() ? std::size_t{1} << precision_ : 0);
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
    if (frequency > (1U << precision_) - sum_) return broken_draco("the frequencies of its symbols are too large");
    if (frequency > 0) add(symbol, frequency);
  }
  if (sum_ != 1U << precision_) return broken_draco("the frequencies of its symbols are too small");
  if (!is_direct()) index_slots();
  return absl::OkStatus();
}

void RansReader::add(std::uint32_t symbol, std::uint32_t frequency) {
  if (is_direct()) {
    Entry* entry = table_.data() + sum_;
    for (std::uint32_t i = 0; i < frequency; ++i) {
      entry[i] = {static_cast<std::uint16_t>(frequency), static_cast<std::uint16_t>(i), symbol};
    }
  } else {
    slots_.push_back({sum_, symbol});
  }
  sum_ += frequency;
}

void RansReader::index_slots() {
  slots_.push_back({sum_, 0});
  first_.resize(std::size_t{1} << kIndexBits);
  const int shift = precision_ - kIndexBits;
  std::uint32_t slot = 0;
  for (std::uint32_t i = 0; i < first_.size(); ++i) {
    while (slots_[slot + 1].start <= i << shift) ++slot;
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

void RansReader::read(std::size_t count, std::uint32_t* symbols) {
  const auto read_all = [&](auto stream) {
    std::generate(symbols, symbols + count, [&] { return stream.next(); });
    stream.put_back(*this);
  };
  if (is_direct()) {
    read_all(Direct(*this));
  } else {
    read_all(Searching(*this));
  }
}

bool RansReader::had_enough() {
  Direct stream(*this);
  stream.refill();
  return stream.state >= stream.least;
}

void RansReader::read_together(const std::array<RansReader*, 3>& readers, std::size_t count,
                               const std::array<std::uint32_t*, 3>& symbols) {
  Direct a(*readers[0]), b(*readers[1]), c(*readers[2]);
  for (std::size_t i = 0; i < count; ++i) {
    symbols[0][3 * i] = a.next();
    symbols[1][2 * i] = b.next();
    symbols[2][i] = c.next();
    symbols[0][3 * i + 1] = a.next();
    symbols[1][2 * i + 1] = b.next();
    symbols[0][3 * i + 2] = a.next();
  }
  a.put_back(*readers[0]);
  b.put_back(*readers[1]);
  c.put_back(*readers[2]);
}

}  // namespace curvecast::client
