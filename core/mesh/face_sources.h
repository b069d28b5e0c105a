// Where the faces of a repaired mesh come from: which polygon of the file each is, or is a part of, and whether it was turned
// over.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>

#include "core/base/column.h"

namespace curvecast {

/// Copies share what they hold.
class FaceSources {
 public:
  /// Every face is the polygon of its own number, as it stands: what repair makes of most files.
  FaceSources() = default;
  /// `codes`: code(polygon, turned) of each face.
  explicit FaceSources(Column<std::uint32_t> codes) : codes_(std::make_shared<const Column<std::uint32_t>>(std::move(codes))) {}

  /// `polygon` < 2^31.
  static std::uint32_t code(std::uint32_t polygon, bool turned) { return 2 * polygon + static_cast<std::uint32_t>(turned); }

  std::uint32_t polygon(std::uint32_t face) const { return has(face) ? (*codes_)[face] / 2 : face; }
  /// Whether the face has the polygon's second and third corner in the other order.
  bool is_turned(std::uint32_t face) const { return has(face) && (*codes_)[face] % 2 != 0; }

  /// Empty where every face is the polygon of its own number.
  std::span<const std::uint32_t> codes() const {
    return codes_ ? std::span<const std::uint32_t>(*codes_) : std::span<const std::uint32_t>();
  }

 private:
  bool has(std::size_t face) const { return codes_ && face < codes_->size(); }

  std::shared_ptr<const Column<std::uint32_t>> codes_;
};

}  // namespace curvecast
