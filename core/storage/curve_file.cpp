#include "core/storage/curve_file.h"

#include <absl/strings/str_cat.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <vector>

#include "core/curve/curve_columns.h"
#include "core/curve/hilbert.h"
#include "core/storage/archive.h"

namespace curvecast {
namespace {

constexpr FileKind kKind = {"CURVE", kCurveFileVersion};
constexpr std::size_t kBlock = 1 << 16;  // entries that a thread checks at a time

/// What is no column.
struct Head {
  Vec3d origin, box_min, box_max;
  std::array<float, kCurvatureKinds> reference_curvature = {};
  double total_area = 0;
  std::uint64_t max_points = 0, revision = 0;
  std::vector<std::string> scalars;
};

template <typename Archive, ConstOr<Head> T>
void archive(Archive& fields, T& head) {
  auto& [origin, box_min, box_max, reference_curvature, total_area, max_points, revision, scalars] = head;
  fields(origin, box_min, box_max, reference_curvature, total_area, max_points, revision, scalars);
}

std::string scalar_section(std::size_t i) { return absl::StrCat("scalar ", i); }

std::string_view text_of(std::span<const char> bytes) { return {bytes.data(), bytes.size()}; }

/// Whether check(begin, end) holds for all blocks of [0, n).
template <typename Check>
bool holds(std::size_t n, const Check& check) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, n, kBlock), true,
      [&](const tbb::blocked_range<std::size_t>& block, bool so_far) { return so_far && check(block.begin(), block.end()); },
      std::logical_and<>());
}

/// Whether is_bad(value) holds for none. Without an early end, so that it becomes vector code.
template <typename T, typename IsBad>
bool none(const Column<T>& column, IsBad is_bad) {
  const T* const values = column.data();
  return holds(column.size(), [values, is_bad](std::size_t begin, std::size_t end) {
    unsigned bad = 0;
    for (std::size_t i = begin; i < end; ++i) bad |= static_cast<unsigned>(is_bad(values[i]));
    return bad == 0;
  });
}

/// By their bits: the exponent of infinities and NaN is all ones.
constexpr auto kIsInfinite = [](float value) { return (std::bit_cast<std::uint32_t>(value) & 0x7f800000u) == 0x7f800000u; };
constexpr auto kIsInfiniteCode = [](Bfloat16 value) { return (value.code & 0x7f80u) == 0x7f80u; };
/// As numbers the codes of floats from 0 up ascend.
constexpr auto kIsNoArea = [](float value) { return std::bit_cast<std::uint32_t>(value) >= 0x7f800000u; };

/// Number of the finest cells in a quad.
std::uint64_t cells(std::uint8_t level) { return std::uint64_t{1} << 2 * (kMaxLevel - level); }

/// Levels are known to be in range.
bool keys_ascend(const SurfaceCurve& curve) {
  const std::uint64_t* const key = curve.key.data();
  const std::uint8_t* const level = curve.level.data();
  return holds(curve.size(), [&](std::size_t begin, std::size_t end) {
    unsigned bad = 0;
    auto disc = std::upper_bound(curve.disc_begin.begin(), curve.disc_begin.end(), begin);
    for (std::size_t l = begin; l < end; ++disc) {
      const std::size_t disc_end = *disc;
      const std::size_t stop = std::min(end, disc_end);
      for (; l < stop; ++l) {
        const std::uint64_t room = l + 1 < disc_end ? key[l + 1] : cells(0);
        bad |= static_cast<unsigned>(key[l] >= room || room - key[l] < cells(level[l]) || key[l] % cells(level[l]) != 0);
      }
    }
    return bad == 0;
  });
}

absl::Status check_lengths(const SurfaceCurve& curve) {
  const std::size_t size = curve.size();
  if (size == 0 || size >= UINT32_MAX) return absl::InvalidArgumentError(absl::StrCat("the curve has ", size, " vertices"));
  absl::Status status;
  const auto check = [&](const std::string& name, std::size_t length) {
    if (length != size) status = absl::InvalidArgumentError(absl::StrCat(name, " has ", length, " entries of ", size));
  };
  visit_columns(curve, [&](const char* name, const auto& column, ColumnLength length) {
    if (length == ColumnLength::kAll || (length == ColumnLength::kAllOrNone && !column.empty())) check(name, column.size());
  });
  for (const ScalarColumn& scalar : curve.scalars) check(scalar.name, scalar.values.size());
  if (!status.ok()) return status;
  const std::vector<std::uint32_t>& discs = curve.disc_begin;
  const auto not_ascending = [](std::uint32_t a, std::uint32_t b) { return a >= b; };
  if (discs.size() < 2 || discs.front() != 0 || discs.back() != size ||
      std::adjacent_find(discs.begin(), discs.end(), not_ascending) != discs.end()) {
    return absl::InvalidArgumentError("the discs do not divide the curve");
  }
  return absl::OkStatus();
}

absl::Status check_head(const SurfaceCurve& curve) {
  const auto is_length = [](float value) { return std::isfinite(value) && value >= 0; };
  const bool good = curve.origin.allFinite() && curve.box.min.allFinite() && curve.box.max.allFinite() &&
                    (curve.box.min.array() <= curve.box.max.array()).all() && std::isfinite(curve.total_area) &&
                    curve.total_area > 0 && curve.max_points > 0 && curve.revision > 0 &&
                    std::all_of(curve.reference_curvature.begin(), curve.reference_curvature.end(), is_length);
  return good ? absl::OkStatus() : absl::InvalidArgumentError("box, area, curvature or number of points is out of range");
}

}  // namespace

absl::Status check_curve(const SurfaceCurve& curve) {
  if (absl::Status status = check_lengths(curve); !status.ok()) return status;
  if (absl::Status status = check_head(curve); !status.ok()) return status;
  const auto wrong = [](const char* what) { return absl::InvalidArgumentError(what); };
  for (const Column<float>* column : {&curve.x, &curve.y, &curve.z}) {
    if (!none(*column, kIsInfinite)) return wrong("a position is not finite");
  }
  for (const Column<Bfloat16>* column : {&curve.curvature_min, &curve.curvature_max}) {
    if (!none(*column, kIsInfiniteCode)) return wrong("a curvature is not finite");
  }
  if (!none(curve.area, kIsNoArea)) return wrong("an area element is negative or not finite");
  if (!none(curve.level, [](std::uint8_t level) { return level > kMaxLevel; })) return wrong("a level is too deep");
  if (!keys_ascend(curve)) return wrong("the keys are out of order");
  return absl::OkStatus();
}

absl::Status save_curve(const std::string& path, const SurfaceCurve& curve, std::string_view note) {
  Head head = {curve.origin,     curve.box.min,    curve.box.max,  curve.reference_curvature,
               curve.total_area, curve.max_points, curve.revision, {}};
  for (const ScalarColumn& scalar : curve.scalars) head.scalars.push_back(scalar.name);
  const std::string head_bytes = to_archive(head);
  std::vector<Section> sections = {make_section("note", note), make_section("head", head_bytes),
                                   make_section("discs", curve.disc_begin),
                                   make_section("face sources", curve.face_sources.codes())};
  visit_columns(curve, [&](const char* name, const auto& column, ColumnLength /*length*/) {
    sections.push_back(make_section(name, column));
  });
  for (std::size_t i = 0; i < curve.scalars.size(); ++i) {
    sections.push_back(make_section(scalar_section(i), curve.scalars[i].values));
  }
  return write_section_file(path, kKind, sections);
}

absl::StatusOr<std::string> load_note(const std::string& path) {
  const absl::StatusOr<std::shared_ptr<const SectionFile>> file = SectionFile::open(path, kKind, FileAccess::kMapLazily);
  if (!file.ok()) return file.status();
  const auto note = (*file)->section<char>("note");
  if (!note.ok()) return note.status();
  if (absl::Status status = (*file)->check(*note); !status.ok()) return status;
  return std::string(note->begin(), note->end());
}

absl::StatusOr<CurveFile> load_curve(const std::string& path, FileAccess access) {
  const absl::StatusOr<std::shared_ptr<const SectionFile>> file = SectionFile::open(path, kKind, access);
  if (!file.ok()) return file.status();
  const auto note = (*file)->section<char>("note");
  if (!note.ok()) return note.status();
  const auto head_bytes = (*file)->section<char>("head");
  if (!head_bytes.ok()) return head_bytes.status();
  const auto discs = (*file)->section<std::uint32_t>("discs");
  if (!discs.ok()) return discs.status();
  Head head;
  if (!from_archive(text_of(*head_bytes), head)) return absl::DataLossError(absl::StrCat(path, ": its head makes no sense"));

  auto curve = std::make_shared<SurfaceCurve>();
  curve->origin = head.origin;
  curve->box = {head.box_min, head.box_max};
  curve->reference_curvature = head.reference_curvature;
  curve->total_area = head.total_area;
  curve->max_points = head.max_points;
  curve->revision = head.revision;
  curve->disc_begin.assign(discs->begin(), discs->end());
  absl::Status status;
  const auto view = [&]<typename T>(std::string_view name, Column<T>& column) {
    const absl::StatusOr<std::span<const T>> values = (*file)->section<T>(name);
    if (values.ok()) {
      column = Column<T>::view(*values, *file);
    } else {
      status = values.status();
    }
  };
  visit_columns(*curve, [&](const char* name, auto& column, ColumnLength /*length*/) { view(name, column); });
  Column<std::uint32_t> codes;
  view("face sources", codes);
  if (!codes.empty()) curve->face_sources = FaceSources(std::move(codes));
  curve->scalars.resize(head.scalars.size());
  for (std::size_t i = 0; i < head.scalars.size(); ++i) {
    curve->scalars[i].name = std::move(head.scalars[i]);
    view(scalar_section(i), curve->scalars[i].values);
  }
  if (!status.ok()) return status;
  if (absl::Status checked = check_curve(*curve); !checked.ok()) {
    return absl::DataLossError(absl::StrCat(path, ": its curve makes no sense: ", checked.message()));
  }
  curve->blocks = build_blocks(*curve);
  return CurveFile{std::move(curve), std::string(note->begin(), note->end()), *file};
}

}  // namespace curvecast
