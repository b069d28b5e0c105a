// SPDX-License-Identifier: Apache-2.0
#include "client/lib/point_blocks.h"

#include <absl/strings/str_cat.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <numeric>
#include <set>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include "client/lib/draco/draco_header.h"
#include "client/lib/draco/draco_points.h"
#include "client/lib/draco/draco_reader.h"
#include "client/lib/draco/point_columns.h"
#include "client/lib/protocol.h"

namespace curvecast::client {
namespace {

static_assert(std::endian::native == std::endian::little, "raw points are copied as they are");

using Vec = std::array<float, 3>;

/// A block and where its points go.
struct Part {
  const v1::PointBlock* block = nullptr;
  std::size_t begin = 0;
  DracoHeaderInfo header;  // of Draco data

  std::size_t count() const { return block->count(); }
  bool has_colours() const { return block->has_raw() ? !block->raw().colours().empty() : header.has_colours(); }
  /// Which of the columns that may be missing it has.
  std::array<bool, 6> columns() const {
    const v1::PointAttributes& more = block->attributes();
    return {has_colours(),         !more.curvatures().empty(),  !more.ranks().empty(),
            !more.faces().empty(), !more.barycentric().empty(), !more.directions().empty()};
  }
  bool has_scalars_of(const Part& other) const {
    const auto &scalars = block->attributes().scalars(), &others = other.block->attributes().scalars();
    return std::equal(scalars.begin(), scalars.end(), others.begin(), others.end(),
                      [](const auto& a, const auto& b) { return a.name() == b.name(); });
  }
};

absl::Status check_size(absl::string_view what, std::size_t bytes, std::uint64_t expected) {
  if (bytes == expected) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(bytes, " bytes of ", what, " where ", expected, " belong"));
}

absl::Status check_raw(const v1::RawPoints& raw, std::uint64_t count) {
  if (absl::Status status = check_size("positions", raw.positions().size(), count * sizeof(Vec)); !status.ok()) return status;
  if (absl::Status status = check_size("normals", raw.normals().size(), count * sizeof(Vec)); !status.ok()) return status;
  if (absl::Status status = check_size("radii", raw.radii().size(), count * sizeof(float)); !status.ok()) return status;
  return raw.colours().empty() ? absl::OkStatus() : check_size("colours", raw.colours().size(), 3 * count);
}

RadiusRange range_of(const v1::DracoPoints& draco) { return {draco.radius_min(), draco.radius_max()}; }

absl::StatusOr<DracoHeaderInfo> check_draco(const v1::PointBlock& block) {
  absl::StatusOr<DracoHeaderInfo> header = check_draco_header(block.draco().data(), kMaxPoints);
  if (!header.ok()) return header;
  if (header->points != block.count()) {
    return absl::InvalidArgumentError(
        absl::StrCat("its Draco data claims ", header->points, " points, the block ", block.count()));
  }
  const RadiusRange range = range_of(block.draco());
  if (!range.valid()) return absl::InvalidArgumentError(absl::StrCat("its radii run from ", range.min, " to ", range.max));
  if (header->find(DracoKind::kNormal) == nullptr || header->find(DracoKind::kGeneric) == nullptr) {
    return absl::InvalidArgumentError("its Draco data lacks normals or radii");
  }
  return header;
}

absl::Status check_attributes(const v1::PointAttributes& more, std::size_t count) {
  const auto fits = [&](const std::string& bytes, std::size_t size) { return bytes.empty() || bytes.size() == count * size; };
  const auto& scalars = more.scalars();
  const bool all_fit =
      fits(more.curvatures(), 8) && fits(more.ranks(), 4) && fits(more.faces(), 4) && fits(more.barycentric(), 8) &&
      fits(more.directions(), 12) &&
      std::all_of(scalars.begin(), scalars.end(), [&](const auto& scalar) { return scalar.values().size() == 4 * count; });
  if (!all_fit) {
    return absl::InvalidArgumentError(absl::StrCat("an attribute has not as many bytes as ", count, " points take"));
  }
  std::set<absl::string_view> names;
  for (const v1::ScalarValues& scalar : scalars) {
    if (!names.insert(scalar.name()).second) return absl::InvalidArgumentError("it has two columns of one name");
  }
  return absl::OkStatus();
}

/// Checks all that needs no decoding, so that memory is taken only for what can be there.
absl::Status check_part(Part& part) {
  const v1::PointBlock& block = *part.block;
  if (block.has_raw()) {
    if (absl::Status status = check_raw(block.raw(), block.count()); !status.ok()) return status;
  } else if (block.count() == 0) {
    return absl::InvalidArgumentError("it holds no points");
  } else if (!block.has_draco()) {
    return absl::InvalidArgumentError("it is neither Draco nor raw");
  } else {
    absl::StatusOr<DracoHeaderInfo> header = check_draco(block);
    if (!header.ok()) return header.status();
    part.header = *std::move(header);
  }
  for (const double o : {block.origin().x(), block.origin().y(), block.origin().z()}) {
    if (!std::isfinite(o)) return absl::InvalidArgumentError("its origin is not finite");
  }
  return check_attributes(block.attributes(), block.count());
}

template <typename T>
void copy_bytes(const std::string& bytes, std::span<T> values) {
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size_bytes());
}

/// A part's share of a column; nothing of one that is missing.
template <typename T>
std::span<T> share_of(const Part& part, std::vector<T>& column) {
  return column.empty() ? std::span<T>() : std::span(column).subspan(part.begin, part.count());
}

/// Attributes that come as they are; finite ones only, but for the mesh's own.
absl::Status copy_attributes(const Part& part, Points& points) {
  const v1::PointAttributes& more = part.block->attributes();
  const auto copy = [&]<typename T>(const std::string& bytes, std::vector<T>& column) {
    const std::span<T> values = share_of(part, column);
    copy_bytes(bytes, values);
    return values;
  };
  copy(more.ranks(), points.ranks);
  copy(more.faces(), points.faces);
  for (std::size_t s = 0; s < points.scalars.size(); ++s) {
    copy(more.scalars(static_cast<int>(s)).values(), points.scalars[s].values);
  }
  const auto all_finite = [](const auto& rows) {
    return std::all_of(rows.begin(), rows.end(), [](const auto& row) {
      return std::all_of(row.begin(), row.end(), [](float value) { return std::isfinite(value); });
    });
  };
  const bool is_good = all_finite(copy(more.curvatures(), points.curvatures)) &&
                       all_finite(copy(more.barycentric(), points.barycentric)) &&
                       all_finite(copy(more.directions(), points.directions));
  return is_good ? absl::OkStatus() : absl::InvalidArgumentError("an attribute is not finite");
}

absl::Status decode_part(const Part& part, DracoReader& reader, Points& points) {
  const PointColumns to = {share_of(part, points.positions), share_of(part, points.normals), share_of(part, points.radii),
                           share_of(part, points.colours)};
  absl::Status status;
  if (part.block->has_raw()) {
    const v1::RawPoints& raw = part.block->raw();
    copy_bytes(raw.positions(), to.positions);
    copy_bytes(raw.normals(), to.normals);
    copy_bytes(raw.radii(), to.radii);
    copy_bytes(raw.colours(), to.colours);
    status = check_finite(to);
  } else {
    status = decode_draco_into(reader, part.block->draco().data(), part.header, range_of(part.block->draco()), to);
  }
  return status.ok() ? copy_attributes(part, points) : status;
}

absl::Status bad_block(const absl::Status& status) {
  return absl::DataLossError(absl::StrCat("the server sent a bad block of points: ", status.message()));
}

/// Room for all parts, once they are known to go together.
absl::StatusOr<Points> make_room(std::span<const Part> parts) {
  Points points;
  const Part* first = nullptr;
  std::size_t total = 0;
  for (const Part& part : parts) {
    const v1::Vec3& o = part.block->origin();
    const std::array<double, 3> origin = {o.x(), o.y(), o.z()};
    if (first != nullptr && origin != points.origin) {
      return absl::DataLossError("the server sent blocks of different origins");
    }
    points.origin = origin;
    if (part.count() == 0) continue;
    if (first == nullptr) first = &part;
    if (part.columns() != first->columns() || !part.has_scalars_of(*first)) {
      return absl::DataLossError("the server sent blocks of which not all have the same attributes");
    }
    total += part.count();
  }
  if (first == nullptr) return points;
  const auto [colours, curvatures, ranks, faces, barycentric, directions] = first->columns();
  points.positions.resize(total);
  points.normals.resize(total);
  points.radii.resize(total);
  points.colours.resize(colours ? total : 0);
  points.curvatures.resize(curvatures ? total : 0);
  points.ranks.resize(ranks ? total : 0);
  points.faces.resize(faces ? total : 0);
  points.barycentric.resize(barycentric ? total : 0);
  points.directions.resize(directions ? total : 0);
  for (const v1::ScalarValues& scalar : first->block->attributes().scalars()) {
    points.scalars.push_back({scalar.name(), std::vector<float>(total)});
  }
  return points;
}

/// Decodes every part, several at once where that pays: starting a thread costs as much as some thousand points.
absl::Status decode_parts(std::span<const Part> parts, Points& points) {
  constexpr std::size_t kPointsPerThread = 16'384;
  std::vector<absl::Status> results(parts.size());
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    DracoReader reader;
    for (std::size_t p = next++; p < parts.size(); p = next++) results[p] = decode_part(parts[p], reader, points);
  };
  {
    const std::size_t most =
        std::min<std::size_t>({parts.size(), std::thread::hardware_concurrency(), points.size() / kPointsPerThread});
    std::vector<std::jthread> helpers;
    for (std::size_t t = 1; t < most; ++t) helpers.emplace_back(work);
    work();
  }
  const auto failed = std::find_if(results.begin(), results.end(), [](const absl::Status& status) { return !status.ok(); });
  return failed == results.end() ? absl::OkStatus() : bad_block(*failed);
}

absl::StatusOr<Points> decode_all(std::span<const v1::PointBlock* const> blocks) {
  std::vector<Part> parts;
  parts.reserve(blocks.size());
  std::size_t begin = 0;
  for (const v1::PointBlock* block : blocks) {
    Part& part = parts.emplace_back(Part{block, begin, {}});
    if (absl::Status status = check_part(part); !status.ok()) return bad_block(status);
    begin += part.count();
  }
  absl::StatusOr<Points> points = make_room(parts);
  if (!points.ok()) return points;
  if (absl::Status status = decode_parts(parts, *points); !status.ok()) return status;
  return points;
}

}  // namespace

absl::StatusOr<Points> decode_block(const v1::PointBlock& block) {
  const v1::PointBlock* one = &block;
  return decode_all({&one, 1});
}

absl::StatusOr<Points> decode_blocks(const google::protobuf::RepeatedPtrField<v1::PointBlock>& blocks) {
  std::uint64_t total = 0;
  for (const v1::PointBlock& block : blocks) total += block.count();
  if (total > kMaxPoints) return absl::DataLossError(absl::StrCat("the server sent ", total, " points in a frame"));
  return decode_all({blocks.data(), static_cast<std::size_t>(blocks.size())});
}

std::uint64_t encoded_bytes(const google::protobuf::RepeatedPtrField<v1::PointBlock>& blocks) {
  return std::accumulate(blocks.begin(), blocks.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const v1::PointBlock& block) { return sum + encoded_bytes(block); });
}

std::uint64_t encoded_bytes(const v1::PointBlock& block) {
  const v1::RawPoints& raw = block.raw();
  const v1::PointAttributes& more = block.attributes();
  std::uint64_t scalars = 0;
  for (const v1::ScalarValues& scalar : more.scalars()) scalars += scalar.values().size();
  return block.draco().data().size() + more.curvatures().size() + more.ranks().size() + more.faces().size() +
         more.barycentric().size() + more.directions().size() + scalars + raw.positions().size() + raw.normals().size() +
         raw.radii().size() + raw.colours().size();
}

bool have_same_columns(const Points& a, const Points& b) {
  const auto are_both = [&](auto... columns) { return (((a.*columns).empty() == (b.*columns).empty()) && ...); };
  return are_both(&Points::normals, &Points::radii, &Points::colours, &Points::curvatures, &Points::ranks, &Points::faces,
                  &Points::barycentric, &Points::directions) &&
         std::equal(a.scalars.begin(), a.scalars.end(), b.scalars.begin(), b.scalars.end(),
                    [](const ScalarColumn& one, const ScalarColumn& other) { return one.name == other.name; });
}

void append_points(Points more, Points* points) {
  if (points->positions.empty()) {
    *points = std::move(more);
    return;
  }
  if (more.origin != points->origin) {
    for (Vec& position : more.positions) {
      for (int axis = 0; axis < 3; ++axis) {
        position[axis] = static_cast<float>(position[axis] + (more.origin[axis] - points->origin[axis]));
      }
    }
  }
  const auto append = [](auto& column, const auto& values) { column.insert(column.end(), values.begin(), values.end()); };
  const auto append_all = [&](auto... columns) { (append(points->*columns, more.*columns), ...); };
  append_all(&Points::positions, &Points::normals, &Points::radii, &Points::colours, &Points::curvatures, &Points::ranks,
             &Points::faces, &Points::barycentric, &Points::directions);
  for (std::size_t s = 0; s < std::min(points->scalars.size(), more.scalars.size()); ++s) {
    append(points->scalars[s].values, more.scalars[s].values);
  }
}

}  // namespace curvecast::client
