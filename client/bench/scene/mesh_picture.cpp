#include "client/bench/scene/mesh_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

namespace curvecast::cli::bench {
namespace {

constexpr double kNear = 1e-6;  // of the distance from eye to target: nothing nearer is drawn
constexpr std::array<std::uint8_t, 3> kClay = {196, 178, 160}, kBackground = {238, 240, 243}, kLine = {92, 97, 112};
constexpr std::array<std::uint8_t, 3> kPale = {232, 228, 222};  // under lines
constexpr int kSamplesAcross = 3;                               // of a pixel with lines
constexpr double kLineWidth = 0.7;                              // pixels

/// A face in eye coordinates (right, up, depth), cut off at the near plane: at most four corners.
struct Cut {
  std::array<Vec3d, 4> corners;
  std::size_t count = 0;
};

Cut cut_at(double near, const std::array<Vec3d, 3>& face) {
  Cut cut;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3d &a = face[i], &b = face[(i + 1) % 3];
    if (a.z() >= near) cut.corners[cut.count++] = a;
    if ((a.z() >= near) != (b.z() >= near)) cut.corners[cut.count++] = a + (near - a.z()) / (b.z() - a.z()) * (b - a);
  }
  return cut;
}

class Canvas {
 public:
  /// `line_width`: of the sides of triangles, pixels; 0: they are not drawn.
  Canvas(int width, int height, double pixels, double line_width)
      : width_(width),
        height_(height),
        pixels_(pixels),
        half_line_(0.5 * line_width),
        inverse_depth_(static_cast<std::size_t>(width * height), 0.0) {
    picture_.image = {width, height, {}};
    for (int i = 0; i < width * height; ++i) {
      picture_.image.rgba.insert(picture_.image.rgba.end(), {kBackground[0], kBackground[1], kBackground[2], 255});
    }
    picture_.covered.resize(inverse_depth_.size());
  }

  void draw(const Vec3d& a, const Vec3d& b, const Vec3d& c, double light) {
    const std::array<Vec3d, 3> p = {projected(a), projected(b), projected(c)};
    const auto cross = [](const Vec3d& o, const Vec3d& s, double x, double y) {
      return (s.x() - o.x()) * (y - o.y()) - (s.y() - o.y()) * (x - o.x());
    };
    const double area = cross(p[0], p[1], p[2].x(), p[2].y());
    if (!(std::abs(area) > 0)) return;
    // Heights over the sides, by which a place's weights become its distances from them.
    std::array<double, 3> heights;
    for (std::size_t i = 0; i < 3; ++i) heights[i] = std::abs(area) / (p[(i + 2) % 3] - p[(i + 1) % 3]).head<2>().norm();
    const auto [left, right] = std::minmax({p[0].x(), p[1].x(), p[2].x()});
    const auto [top, bottom] = std::minmax({p[0].y(), p[1].y(), p[2].y()});
    const int x_begin = first(left, width_), x_end = first(right, width_);
    const int y_begin = first(top, height_), y_end = first(bottom, height_);
    for (int row = y_begin; row < y_end; ++row) {
      for (int column = x_begin; column < x_end; ++column) {
        const double x = column + 0.5, y = row + 0.5;
        const double u = cross(p[1], p[2], x, y) / area, v = cross(p[2], p[0], x, y) / area, w = 1 - u - v;
        if (u < 0 || v < 0 || w < 0) continue;
        put(static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(column),
            u * p[0].z() + v * p[1].z() + w * p[2].z(), light,
            std::min({u * heights[0], v * heights[1], w * heights[2]}) < half_line_);
      }
    }
  }

  MeshPicture take() && { return std::move(picture_); }

 private:
  /// To pixels from the left and the top, and the inverse depth, which is linear on the picture.
  Vec3d projected(const Vec3d& p) const {
    return {0.5 * width_ + pixels_ * p.x() / p.z(), 0.5 * height_ - pixels_ * p.y() / p.z(), 1 / p.z()};
  }
  /// The first pixel whose middle does not lie before x.
  static int first(double x, int size) {
    return static_cast<int>(std::clamp(std::ceil(x - 0.5), 0.0, static_cast<double>(size)));
  }

  void put(std::size_t pixel, double inverse_depth, double light, bool is_line) {
    if (inverse_depth <= inverse_depth_[pixel]) return;
    inverse_depth_[pixel] = inverse_depth;
    picture_.covered[pixel] = 1;
    for (std::size_t c = 0; c < 3; ++c) {
      const double lit = light * (half_line_ > 0 ? kPale[c] : kClay[c]);
      picture_.image.rgba[4 * pixel + c] = is_line ? kLine[c] : static_cast<std::uint8_t>(lit);
    }
  }

  int width_, height_;
  double pixels_;     // of a length of 1 at depth 1
  double half_line_;  // pixels
  std::vector<double> inverse_depth_;
  MeshPicture picture_;
};

MeshPicture draw(const TriangleMesh& mesh, const RenderCamera& camera, int width, int height, double line_width) {
  const Vec3d forward = (camera.target - camera.eye).normalized(), right = forward.cross(camera.up).normalized();
  const Vec3d up = right.cross(forward);
  const double near = kNear * (camera.target - camera.eye).norm();
  Canvas canvas(width, height, 0.5 * height / std::tan(camera.vertical_fov_degrees * std::numbers::pi / 360), line_width);
  for (const Triangle& triangle : mesh.triangles) {
    std::array<Vec3d, 3> face;
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3d from_eye = mesh.positions[triangle[c]] - camera.eye;
      face[c] = {right.dot(from_eye), up.dot(from_eye), forward.dot(from_eye)};
    }
    const Cut cut = cut_at(near, face);
    if (cut.count < 3) continue;
    const Vec3d normal = (face[1] - face[0]).cross(face[2] - face[0]);
    const double light = 0.25 + 0.75 * std::abs(normal.z()) / std::max(normal.norm(), std::numeric_limits<double>::min());
    for (std::size_t i = 2; i < cut.count; ++i) canvas.draw(cut.corners[0], cut.corners[i - 1], cut.corners[i], light);
  }
  return std::move(canvas).take();
}

/// The means of squares of kSamplesAcross pixels.
Image averaged(const Image& fine) {
  Image image{fine.width / kSamplesAcross, fine.height / kSamplesAcross, {}};
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      std::array<int, 4> sum{};
      for (int i = 0; i < kSamplesAcross * kSamplesAcross; ++i) {
        const int row = kSamplesAcross * y + i / kSamplesAcross, column = kSamplesAcross * x + i % kSamplesAcross;
        const std::uint8_t* const pixel = &fine.rgba[4 * static_cast<std::size_t>(row * fine.width + column)];
        for (std::size_t c = 0; c < 4; ++c) sum[c] += pixel[c];
      }
      for (const int value : sum) image.rgba.push_back(static_cast<std::uint8_t>(value / (kSamplesAcross * kSamplesAcross)));
    }
  }
  return image;
}

}  // namespace

MeshPicture draw_mesh(const TriangleMesh& mesh, const RenderCamera& camera, int width, int height) {
  return draw(mesh, camera, width, height, 0);
}

Image draw_wireframe(const TriangleMesh& mesh, const RenderCamera& camera, int width, int height) {
  return averaged(draw(mesh, camera, kSamplesAcross * width, kSamplesAcross * height, kSamplesAcross * kLineWidth).image);
}

}  // namespace curvecast::cli::bench
