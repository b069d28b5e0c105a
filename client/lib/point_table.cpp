// SPDX-License-Identifier: Apache-2.0
#include "client/lib/point_table.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <string>
#include <system_error>
#include <utility>

namespace curvecast::client {
namespace {

absl::Status broken(std::string_view what) { return absl::InvalidArgumentError({what.data(), what.size()}); }
template <class T>
bool parse(std::string_view word, T& value) {
  if (word.starts_with('+')) word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size();
}

absl::Status broken_at(std::size_t line, std::string_view what) { return broken(absl::StrFormat("line %d: %s", line, what)); }

double scalar_at(const char* p, const PointColumn& column) {
  const auto as = [p](auto value) {
    std::memcpy(&value, p, sizeof(value));
    return static_cast<double>(value);
  };
  if (column.kind == ColumnKind::kFloat) return column.bytes == 4 ? as(float{}) : as(double{});
  const bool is_signed = column.kind == ColumnKind::kSigned;
  switch (column.bytes) {
    case 1:
      return is_signed ? as(std::int8_t{}) : as(std::uint8_t{});
    case 2:
      return is_signed ? as(std::int16_t{}) : as(std::uint16_t{});
    case 4:
      return is_signed ? as(std::int32_t{}) : as(std::uint32_t{});
    default:
      return is_signed ? as(std::int64_t{}) : as(std::uint64_t{});
  }
}

// What a point takes from a row, in this order.
enum Slot { kX, kY, kZ, kNormalX, kNormalY, kNormalZ, kRed, kGreen, kBlue, kPackedColour, kRadius, kSlots };
constexpr std::pair<std::string_view, Slot> kSlotNames[] = {{"x", kX},
                                                            {"y", kY},
                                                            {"z", kZ},
                                                            {"nx", kNormalX},
                                                            {"ny", kNormalY},
                                                            {"nz", kNormalZ},
                                                            {"normal_x", kNormalX},
                                                            {"normal_y", kNormalY},
                                                            {"normal_z", kNormalZ},
                                                            {"red", kRed},
                                                            {"green", kGreen},
                                                            {"blue", kBlue},
                                                            {"rgb", kPackedColour},
                                                            {"rgba", kPackedColour},
                                                            {"radius", kRadius}};

/// A channel as files have it: floats from 0 to 1, anything else from 0 to 255.
std::uint8_t channel_of(double value, const PointColumn& column) {
  if (column.kind == ColumnKind::kFloat) value *= 255;
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
}

/// 0xRRGGBB under whatever stands in the highest byte; PCL has it as the bits of a float, too.
std::array<std::uint8_t, 3> unpack_colour(double value, const PointColumn& column) {
  const auto bits = column.kind == ColumnKind::kFloat ? std::bit_cast<std::uint32_t>(static_cast<float>(value))
                                                      : static_cast<std::uint32_t>(static_cast<std::int64_t>(value));
  return {static_cast<std::uint8_t>(bits >> 16), static_cast<std::uint8_t>(bits >> 8), static_cast<std::uint8_t>(bits)};
}

class TableReader {
 public:
  explicit TableReader(const PointTable& table) : table_(table) {}

  absl::StatusOr<Points> read() {
    if (absl::Status status = find_slots(); !status.ok()) return status;
    const std::uint64_t fit = table_.binary ? table_.body.size() / stride_ : (table_.body.size() + 1) / (2 * scalars_);
    const std::uint64_t rows = table_.rows.value_or(fit);
    if (rows > fit)
      return broken(absl::StrFormat("point %d: the file ends here at the latest, but its header claims %d", fit, rows));
    if (rows == 0) return std::move(points_);
    coordinates_.reserve(rows);
    if (used_[kNormalX]) points_.normals.reserve(rows);
    if (used_[kRadius]) points_.radii.reserve(rows);
    if (used_[kRed] || used_[kPackedColour]) points_.colours.reserve(rows);
    if (absl::Status status = table_.binary ? read_binary(rows) : read_text(); !status.ok()) return status;
    place_origin();
    return std::move(points_);
  }

 private:
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  absl::Status find_slots() {
    std::fill(std::begin(scalar_of_), std::end(scalar_of_), kNone);
    for (const PointColumn& column : table_.columns) {
      for (const auto& [name, slot] : kSlotNames) {
        if (name != column.name || column.count != 1 || scalar_of_[slot] != kNone) continue;
        scalar_of_[slot] = scalars_;
        offset_of_[slot] = stride_;
        column_of_[slot] = &column;
      }
      scalars_ += column.count;
      stride_ += column.count * column.bytes;
    }
    for (const Slot slot : {kX, kY, kZ}) {
      if (scalar_of_[slot] == kNone) return broken(absl::StrFormat("the points have no '%s'", kSlotNames[slot].first));
    }
    // A group counts only where it is whole.
    const auto use = [this](std::initializer_list<Slot> group) {
      const bool whole = std::all_of(group.begin(), group.end(), [this](Slot slot) { return scalar_of_[slot] != kNone; });
      for (const Slot slot : group) used_[slot] = whole;
    };
    use({kX, kY, kZ});
    use({kNormalX, kNormalY, kNormalZ});
    use({kRed, kGreen, kBlue});
    use({kPackedColour});
    use({kRadius});
    if (used_[kRed]) used_[kPackedColour] = false;
    if (used_[kPackedColour] && table_.binary && column_of_[kPackedColour]->bytes == 4) {
      // The bits as they are: a float that is no number would not keep them.
      packed_bits_ = *column_of_[kPackedColour];
      packed_bits_.kind = ColumnKind::kUnsigned;
      column_of_[kPackedColour] = &packed_bits_;
    }
    return absl::OkStatus();
  }

  // False when a number is not finite, as a float.
  bool add(const std::array<double, kSlots>& row) {
    for (int slot = 0; slot < kSlots; ++slot) {
      if (used_[slot] && !(std::abs(row[slot]) <= std::numeric_limits<float>::max())) return false;
    }
    coordinates_.push_back({row[kX], row[kY], row[kZ]});
    const auto f = [&row](Slot slot) { return static_cast<float>(row[slot]); };
    if (used_[kNormalX]) points_.normals.push_back({f(kNormalX), f(kNormalY), f(kNormalZ)});
    const auto channel = [&](Slot slot) { return channel_of(row[slot], *column_of_[slot]); };
    if (used_[kRed]) points_.colours.push_back({channel(kRed), channel(kGreen), channel(kBlue)});
    if (used_[kPackedColour]) points_.colours.push_back(unpack_colour(row[kPackedColour], *column_of_[kPackedColour]));
    if (used_[kRadius]) points_.radii.push_back(f(kRadius));
    return true;
  }

  absl::Status read_binary(std::uint64_t rows) {
    const char* p = table_.body.data();
    std::array<double, kSlots> row{};
    for (std::uint64_t i = 0; i < rows; ++i, p += stride_) {
      for (int slot = 0; slot < kSlots; ++slot) {
        if (used_[slot]) row[slot] = scalar_at(p + offset_of_[slot], *column_of_[slot]);
      }
      if (!add(row)) return broken(absl::StrFormat("point %d: a number is not finite", i));
    }
    return absl::OkStatus();
  }

  absl::Status read_text() {
    std::vector<int> slot_of(scalars_, -1);
    for (int slot = 0; slot < kSlots; ++slot) {
      if (used_[slot]) slot_of[scalar_of_[slot]] = slot;
    }
    std::string_view text = table_.body;
    std::array<double, kSlots> row{};
    std::size_t line_number = table_.first_line;
    for (; !text.empty() && coordinates_.size() < table_.rows.value_or(UINT64_MAX); ++line_number) {
      std::string_view line = take_line(text);
      const std::size_t first = line.find_first_not_of(" \t");
      if (first == std::string_view::npos || line[first] == '#' || line.substr(first).starts_with("//")) continue;
      for (std::size_t scalar = 0; scalar < scalars_; ++scalar) {
        const std::string_view word = take_word(line);
        if (word.empty()) return broken_at(line_number, absl::StrFormat("expected %d numbers, found %d", scalars_, scalar));
        if (slot_of[scalar] >= 0 && !parse_number(word, row[slot_of[scalar]])) {
          return broken_at(line_number, absl::StrFormat("expected a number in column %d", scalar + 1));
        }
      }
      if (!add(row)) return broken_at(line_number, "a number is not finite");
    }
    if (table_.rows && coordinates_.size() < *table_.rows) {
      return broken_at(line_number, absl::StrFormat("the file ends after %d of %d points", coordinates_.size(), *table_.rows));
    }
    return absl::OkStatus();
  }

  // Floats around zero are good enough unless the points lie far from it, all close together, in more digits than a float holds.
  void place_origin() {
    constexpr double kFar = 16;  // in sizes of the points' box: four bits lost
    std::array<double, 3> low = coordinates_.empty() ? std::array<double, 3>{} : coordinates_.front();
    std::array<double, 3> high = low;
    bool exact = true;
    for (const std::array<double, 3>& p : coordinates_) {
      for (int axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], p[axis]);
        high[axis] = std::max(high[axis], p[axis]);
        exact = exact && double{static_cast<float>(p[axis])} == p[axis];
      }
    }
    double size = 0;
    double distance = 0;
    for (int axis = 0; axis < 3; ++axis) {
      size = std::max(size, high[axis] - low[axis]);
      distance = std::max({distance, std::abs(low[axis]), std::abs(high[axis])});
    }
    if (!exact && distance > kFar * size) {
      for (int axis = 0; axis < 3; ++axis) points_.origin[axis] = 0.5 * low[axis] + 0.5 * high[axis];
    }
    points_.positions.resize(coordinates_.size());
    for (std::size_t i = 0; i < coordinates_.size(); ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        points_.positions[i][axis] = static_cast<float>(coordinates_[i][axis] - points_.origin[axis]);
      }
    }
  }

  const PointTable& table_;
  std::size_t scalar_of_[kSlots];
  std::size_t offset_of_[kSlots] = {};
  const PointColumn* column_of_[kSlots] = {};
  std::size_t scalars_ = 0;  // in a row
  std::size_t stride_ = 0;   // bytes of a row
  bool used_[kSlots] = {};
  PointColumn packed_bits_;
  std::vector<std::array<double, 3>> coordinates_;
  Points points_;
};

}  // namespace

absl::StatusOr<Points> read_point_table(const PointTable& table) { return TableReader(table).read(); }

std::string_view take_line(std::string_view& text) {
  const std::size_t length = std::min(text.find('\n'), text.size());
  std::string_view line = text.substr(0, length);
  text.remove_prefix(std::min(length + 1, text.size()));
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

std::string_view take_word(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(" \t"));
  line.remove_prefix(word.size());
  return word;
}

bool parse_number(std::string_view word, double& value) { return parse(word, value); }
bool parse_number(std::string_view word, std::uint64_t& value) { return parse(word, value); }

}  // namespace curvecast::client
