// A curve as a file: its columns, used where they lie in the mapped file.
#pragma once

#include <absl/status/statusor.h>

#include <memory>
#include <string>
#include <string_view>

#include "core/curve/surface_curve.h"
#include "core/storage/section_file.h"

namespace curvecast {

/// Grows when what the files hold changes.
inline constexpr std::uint32_t kCurveFileVersion = 8;

struct CurveFile {
  std::shared_ptr<const SurfaceCurve> curve;
  std::string note;                         // what save_curve() was given
  std::shared_ptr<const SectionFile> file;  // in which the curve's columns lie: its status() is theirs
};

/// Saves a curve. `note` is whatever else the file shall hold. Errors as of write_section_file.
absl::Status save_curve(const std::string& path, const SurfaceCurve& curve, std::string_view note = {});

/// Loads a curve. Errors as of SectionFile::open, and DataLoss where the content makes no sense.
absl::StatusOr<CurveFile> load_curve(const std::string& path, FileAccess access = FileAccess::kMap);

/// Loads the note alone, in the same time for any curve. Errors as of load_curve().
absl::StatusOr<std::string> load_note(const std::string& path);

/// Checks that later stages can take the curve: lengths agree, keys ascend in each disc and no quads overlap, numbers are finite
/// and in range. InvalidArgument says what is wrong. Reads all columns once, on all cores. Does not check `triangle`, because the
/// curve does not know which faces there are.
absl::Status check_curve(const SurfaceCurve& curve);

}  // namespace curvecast
