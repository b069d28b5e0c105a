// Lines and numbers on a picture, antialiased. Glyphs: A. V. Hershey, "Calligraphy for computers" (1967), simplex.
#pragma once

#include <string_view>

#include "core/base/image.h"
#include "core/base/vec.h"
#include "core/render/splat_renderer.h"

namespace curvecast {

/// A line with round ends. Coordinates in pixels from the upper left corner, pixel centres at halves; what lies outside is left
/// out.
void draw_line(Image& image, const Vec2d& from, const Vec2d& to, double width, const Rgb8& color, double opacity = 1);

/// Digits and '/' (anything else is a blank), `height` pixels high, centred on x, with the baseline at y.
void draw_text(Image& image, std::string_view text, const Vec2d& at, double height, const Rgb8& color);

}  // namespace curvecast
