// SPDX-License-Identifier: Apache-2.0
#include "client/lib/point_edits.h"

#include <absl/strings/str_cat.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "client/lib/point_blocks.h"
#include "client/lib/protocol.h"

namespace curvecast::client {
namespace {

using Indices = std::vector<std::size_t>;

/// The first index, then the differences; ascending, and below `size`.
absl::StatusOr<Indices> read_indices(const google::protobuf::RepeatedField<std::uint32_t>& steps, std::size_t size,
                                     const char* what) {
  Indices indices;
  indices.reserve(static_cast<std::size_t>(steps.size()));
  std::size_t last = 0;
  for (const std::uint32_t step : steps) {
    if (step == 0 && !indices.empty()) return absl::InvalidArgumentError(absl::StrCat(what, " holds an index twice"));
    last += step;
    if (last >= size) return absl::InvalidArgumentError(absl::StrCat(what, " holds index ", last, " of ", size));
    indices.push_back(last);
  }
  return indices;
}

/// Points that stand together in one of the lists, and do so in the new one.
struct Run {
  bool is_added;
  std::size_t begin, count;
};

/// The new list, made of the two. `size`: of the new one.
std::vector<Run> make_runs(std::size_t held, const Indices& removed, const Indices& added, std::size_t size) {
  std::vector<Run> runs;
  std::size_t next_held = 0, written = 0;
  auto gone = removed.begin();
  const auto keep = [&](std::size_t count) {
    written += count;
    while (count > 0) {
      while (gone != removed.end() && *gone == next_held) ++gone, ++next_held;
      const std::size_t end = gone == removed.end() ? held : *gone;
      const std::size_t part = std::min(count, end - next_held);
      runs.push_back({false, next_held, part});
      next_held += part;
      count -= part;
    }
  };
  for (std::size_t i = 0; i < added.size();) {
    keep(added[i] - written);
    std::size_t end = i + 1;
    while (end < added.size() && added[end] == added[end - 1] + 1) ++end;
    runs.push_back({true, i, end - i});
    written += end - i;
    i = end;
  }
  keep(size - written);
  return runs;
}

template <typename Column, typename T>
void join(const Column& held, const Column& added, const std::vector<Run>& runs, std::size_t size, std::vector<T>& out) {
  if (held.empty() && added.empty()) return;
  out.reserve(size);
  for (const Run& run : runs) {
    const auto from = (run.is_added ? added : held).begin() + static_cast<std::ptrdiff_t>(run.begin);
    out.insert(out.end(), from, from + static_cast<std::ptrdiff_t>(run.count));
  }
}

absl::Status resize(const v1::PointEdits& edits, std::vector<float>& radii) {
  if (edits.resized().empty()) return absl::OkStatus();
  const float largest = edits.radius_max();
  if (!(largest > 0) || !std::isfinite(largest)) return absl::InvalidArgumentError("radius_max is no radius");
  std::uint64_t i = 0;
  for (const std::uint32_t code : edits.resized()) {
    i += code / 2;
    if (i >= radii.size()) return absl::InvalidArgumentError(absl::StrCat("resized holds index ", i, " of ", radii.size()));
    const double rung = std::round(kRadiusRungsPerOctave * std::log2(largest / radii[i])) + (code % 2 == 0 ? -1 : 1);
    radii[i] = static_cast<float>(largest * std::exp2(-std::clamp(rung, 0.0, kRadiusRungs - 1.0) / kRadiusRungsPerOctave));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<Points> apply_edits(const Points& held, const v1::PointEdits& edits, const Points& added) {
  const absl::StatusOr<Indices> removed = read_indices(edits.removed(), held.size(), "removed");
  if (!removed.ok()) return removed.status();
  const std::size_t size = held.size() - removed->size() + added.size();
  if (size > kMaxPoints) return absl::InvalidArgumentError(absl::StrCat("there would be ", size, " points after it"));
  const absl::StatusOr<Indices> places = read_indices(edits.added(), size, "added");
  if (!places.ok()) return places.status();
  if (places->size() != added.size()) {
    return absl::InvalidArgumentError(absl::StrCat("added has ", places->size(), " indices for ", added.size(), " points"));
  }
  const bool both = held.size() > 0 && added.size() > 0;
  if (both && !have_same_columns(held, added)) {
    return absl::InvalidArgumentError("the points that are added have other attributes than those held");
  }
  if (both && held.origin != added.origin) {
    return absl::InvalidArgumentError("the points that are added have another origin than those held");
  }
  const std::vector<Run> runs = make_runs(held.size(), *removed, *places, size);
  Points out;
  out.origin = held.size() > 0 ? held.origin : added.origin;
  const auto join_all = [&](auto... columns) { (join(held.*columns, added.*columns, runs, size, out.*columns), ...); };
  join_all(&Points::positions, &Points::normals, &Points::radii, &Points::colours, &Points::curvatures, &Points::ranks,
           &Points::faces, &Points::barycentric, &Points::directions);
  const std::vector<ScalarColumn>& like = held.size() > 0 ? held.scalars : added.scalars;
  for (std::size_t s = 0; s < like.size(); ++s) {
    using Values = std::span<const float>;
    const auto values_of = [s](const Points& list) { return list.size() > 0 ? Values(list.scalars[s].values) : Values(); };
    out.scalars.push_back({like[s].name, {}});
    join(values_of(held), values_of(added), runs, size, out.scalars[s].values);
  }
  if (absl::Status status = resize(edits, out.radii); !status.ok()) return status;
  return out;
}

}  // namespace curvecast::client
