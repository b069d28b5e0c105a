#include "core/reference/id_buffer.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "core/base/column.h"
#include "core/curve/deepest_triangle.h"
#include "core/render/gl_context_osmesa.h"
#include "core/render/gl_functions_osmesa.h"

namespace curvecast {
namespace {

constexpr int kMaxLogSide = 10;  // of a picture: texels along its side, as a power of two
// A section with fewer leaves than this is not worth a picture, nor is a picture with more texels than this for each leaf while
// its section can be divided.
constexpr std::size_t kFewLeaves = 64;
constexpr double kManyTexels = 8;
constexpr std::size_t kGrain = 4096;  // leaves
constexpr int kMaxSteps = 64;         // of a walk

constexpr char kVertexShader[] =
    "#version 330 core\n"
    "layout(location = 0) in vec2 place;\n"
    "layout(location = 1) in uint number;\n"
    "flat out uint id;\n"
    "void main() {\n"
    "  gl_Position = vec4(place, 0.0, 1.0);\n"
    "  id = number;\n"
    "}\n";
constexpr char kFragmentShader[] =
    "#version 330 core\n"
    "flat in uint id;\n"
    "out uint color;\n"
    "void main() { color = id; }\n";

struct IdVertex {
  float x, y;  // in [-1, 1] within the section
  std::uint32_t number;
};

/// A square of the quadtree that is drawn as one picture.
struct Section {
  double x, y, side;
  std::size_t begin, end;  // its leaves
};

}  // namespace

/// Draws sections.
class IdBuffer::Canvas {
 public:
  static absl::StatusOr<std::unique_ptr<Canvas>> create() {
    absl::StatusOr<std::unique_ptr<GlContext>> context = GlContext::create();
    if (!context.ok()) return context.status();
    auto canvas = std::make_unique<Canvas>();
    canvas->context_ = *std::move(context);
    if (const absl::StatusOr<unsigned> program = link_gl_program(kVertexShader, {kFragmentShader}); !program.ok()) {
      return program.status();
    }
    GLuint array = 0, buffer = 0;
    gl.GenVertexArrays(1, &array);
    gl.BindVertexArray(array);
    gl.GenBuffers(1, &buffer);
    gl.BindBuffer(GL_ARRAY_BUFFER, buffer);
    gl.EnableVertexAttribArray(0);
    gl.VertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, sizeof(IdVertex), nullptr);
    gl.EnableVertexAttribArray(1);
    gl.VertexAttribIPointer(1, 1, GL_UNSIGNED_INT, sizeof(IdVertex), reinterpret_cast<const void*>(offsetof(IdVertex, number)));
    // Targets of whole numbers are never blended, dithered or smoothed.
    canvas->ids_.resize(std::size_t{1} << 2 * kMaxLogSide);
    absl::Status status = check_gl("its first calls");
    GlContext::release_current();
    if (!status.ok()) return status;
    return canvas;
  }

  absl::Status make_current() { return context_->make_current(); }

  /// 2^log_side x 2^log_side numbers, row by row upwards: a triangle's place in the list plus one, or 0 where there is none.
  absl::StatusOr<const std::uint32_t*> draw(const Section& section, std::span<const std::uint32_t> list,
                                            std::span<const ParameterTriangle> triangles, int log_side) {
    // In double precision: floats would not do deep in the square.
    const double scale = 2 / section.side;
    vertices_.resize(3 * list.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, list.size(), kGrain), [&](const auto& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) {
        const ParameterTriangle& t = triangles[list[i]];
        for (std::size_t k = 0; k < 3; ++k) {
          vertices_[3 * i + k] = {static_cast<float>((t.u[k] - section.x) * scale - 1),
                                  static_cast<float>((t.v[k] - section.y) * scale - 1), static_cast<std::uint32_t>(i + 1)};
        }
      }
    });
    if (absl::Status status = bind_target(log_side); !status.ok()) return status;
    const int side = 1 << log_side;
    constexpr GLuint kNothing[4] = {};
    gl.Viewport(0, 0, side, side);
    gl.ClearBufferuiv(GL_COLOR, 0, kNothing);
    gl.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices_.size() * sizeof(IdVertex)), vertices_.data(),
                  GL_STREAM_DRAW);
    gl.DrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(vertices_.size()));
    gl.ReadPixels(0, 0, side, side, GL_RED_INTEGER, GL_UNSIGNED_INT, ids_.data());
    if (absl::Status status = check_gl("a picture of the parameter mesh"); !status.ok()) return status;
    return ids_.data();
  }

 private:
  absl::Status bind_target(int log_side) {
    GLuint& target = targets_[static_cast<std::size_t>(log_side)];
    if (target == 0) {
      GLuint texture = 0;
      gl.GenTextures(1, &texture);
      gl.BindTexture(GL_TEXTURE_2D, texture);
      gl.TexImage2D(GL_TEXTURE_2D, 0, GL_R32UI, 1 << log_side, 1 << log_side, 0, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
      gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
      gl.GenFramebuffers(1, &target);
      gl.BindFramebuffer(GL_FRAMEBUFFER, target);
      gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
      if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
        return absl::InternalError("OSMesa cannot draw into textures of 32-bit numbers");
      }
    }
    gl.BindFramebuffer(GL_FRAMEBUFFER, target);
    return absl::OkStatus();
  }

  std::unique_ptr<GlContext> context_;
  std::array<GLuint, kMaxLogSide + 1> targets_{};  // framebuffers; 0 = not made yet
  Column<IdVertex> vertices_;
  Column<std::uint32_t> ids_;
};

namespace {

/// One disc on its way through the pictures.
template <typename Canvas>
class Locator {
 public:
  Locator(Canvas& canvas, const Chart& chart, std::span<const ParameterTriangle> triangles, const QuadtreeLeaves& leaves,
          std::span<std::uint32_t> under, const ExecutionContext& context)
      : canvas_(canvas), twins_(chart.disc.twins), triangles_(triangles), leaves_(leaves), under_(under), context_(context) {}

  absl::Status run() {
    std::vector<std::uint32_t> all(triangles_.size());
    for (std::uint32_t t = 0; t < all.size(); ++t) all[t] = t;
    return visit({0, 0, 1, 0, leaves_.size()}, 0, 0, 0, all);
  }

  IdBufferCounts counts() const { return {sections_, texels_, walked_, searched_}; }

 private:
  /// The square of the given level, whose first key and state are these: drawn whole, or in quarters. `list`: the triangles that
  /// may reach into it.
  absl::Status visit(const Section& section, int level, std::uint64_t key, HilbertState state,
                     std::span<const std::uint32_t> list) {
    if (section.begin == section.end) return absl::OkStatus();
    if (absl::Status status = context_.check(); !status.ok()) return status;
    const std::size_t count = section.end - section.begin;
    if (count < kFewLeaves) {
      look_up(section, list, nullptr, 0);
      return absl::OkStatus();
    }
    const int depth = *std::max_element(leaves_.level.begin() + static_cast<std::ptrdiff_t>(section.begin),
                                        leaves_.level.begin() + static_cast<std::ptrdiff_t>(section.end));
    const int log_side = depth - level;
    if (log_side <= kMaxLogSide && std::ldexp(1.0, 2 * log_side) <= kManyTexels * static_cast<double>(count)) {
      const absl::StatusOr<const std::uint32_t*> ids = canvas_.draw(section, list, triangles_, log_side);
      if (!ids.ok()) return ids.status();
      ++sections_;
      texels_ += std::uint64_t{1} << 2 * log_side;
      look_up(section, list, *ids, log_side);
      return absl::OkStatus();
    }
    return divide(section, level, key, state, list);
  }

  absl::Status divide(const Section& section, int level, std::uint64_t key, HilbertState state,
                      std::span<const std::uint32_t> list) {
    const double half = 0.5 * section.side;
    const double middle_x = section.x + half, middle_y = section.y + half;
    std::array<std::vector<std::uint32_t>, 4> lists;  // of the quadrants: bit 0 = right half, bit 1 = upper half
    for (const std::uint32_t t : list) {
      const auto [left, right] = std::minmax({triangles_[t].u[0], triangles_[t].u[1], triangles_[t].u[2]});
      const auto [below, above] = std::minmax({triangles_[t].v[0], triangles_[t].v[1], triangles_[t].v[2]});
      const bool in_left = left <= middle_x && right >= section.x;
      const bool in_right = right >= middle_x && left <= section.x + section.side;
      const bool in_lower = below <= middle_y && above >= section.y;
      const bool in_upper = above >= middle_y && below <= section.y + section.side;
      if (in_left && in_lower) lists[0].push_back(t);
      if (in_right && in_lower) lists[1].push_back(t);
      if (in_left && in_upper) lists[2].push_back(t);
      if (in_right && in_upper) lists[3].push_back(t);
    }
    const std::uint64_t cells = std::uint64_t{1} << 2 * (kMaxLevel - level - 1);
    std::size_t begin = section.begin;
    for (unsigned i = 0; i < 4; ++i, key += cells) {
      const auto last = leaves_.key.begin() + static_cast<std::ptrdiff_t>(section.end);
      const auto end = static_cast<std::size_t>(
          std::lower_bound(leaves_.key.begin() + static_cast<std::ptrdiff_t>(begin), last, key + cells) - leaves_.key.begin());
      const unsigned quadrant = hilbert_quadrant(state, i);
      const Section child{quadrant & 1 ? middle_x : section.x, quadrant >> 1 ? middle_y : section.y, half, begin, end};
      absl::Status status = visit(child, level + 1, key, hilbert_child_state(state, i), lists[quadrant]);
      if (!status.ok()) return status;
      begin = end;
    }
    return absl::OkStatus();
  }

  /// `ids`: the picture, or null where there is none.
  void look_up(const Section& section, std::span<const std::uint32_t> list, const std::uint32_t* ids, int log_side) {
    const double scale = std::ldexp(1 / section.side, log_side);
    const auto look = [&](const tbb::blocked_range<std::size_t>& range) {
      std::uint64_t walked = 0, searched = 0;
      std::uint32_t found = list[0];
      for (std::size_t l = range.begin(); l < range.end(); ++l) {
        const double half = 0.5 * side_of_level(leaves_.level[l]);
        const double u = leaves_.x[l] * kCellSide + half, v = leaves_.y[l] * kCellSide + half;
        if (ids != nullptr) {
          const auto x = static_cast<std::size_t>((u - section.x) * scale);
          const auto y = static_cast<std::size_t>((v - section.y) * scale);
          const std::uint32_t number = ids[(y << log_side) + x];
          if (number != 0) found = list[number - 1];
        }
        if (!(triangles_[found].weights(u, v).minCoeff() >= 0)) {
          ++walked;
          if (!walk(found, u, v)) {
            ++searched;
            found = deepest_triangle(triangles_, list, u, v);
          }
        }
        under_[l] = found;
      }
      walked_ += walked;
      searched_ += searched;
    };
    // Fixed blocks: a walk may start at the triangle of the leaf before. Isolated: while it waits this thread must not take up
    // other work that draws, in a context of its own.
    tbb::this_task_arena::isolate([&] {
      tbb::parallel_for(tbb::blocked_range<std::size_t>(section.begin, section.end, kGrain), look, tbb::simple_partitioner());
    });
  }

  /// Walks from triangle `t` to the one that holds the place, always across the side beyond which the place lies farthest. False
  /// if it does not come there. Between two triangles, on whose common side the place lies but for rounding, the deeper one
  /// counts.
  bool walk(std::uint32_t& t, double u, double v) const {
    constexpr double kRounding = 1e-9;  // in barycentric coordinates
    std::uint32_t previous = kNone;
    double previous_depth = 0;
    for (int step = 0; step < kMaxSteps; ++step) {
      const Vec3d weights = triangles_[t].weights(u, v);
      Eigen::Index corner = 0;
      const double depth = weights.minCoeff(&corner);
      if (depth >= 0) return true;
      const std::uint32_t twin = twins_[3 * t + (static_cast<std::uint32_t>(corner) + 1) % 3];
      if (twin == kNone) return depth > -kRounding;
      if (twin / 3 == previous) {
        if (previous_depth > depth) t = previous;
        return std::max(depth, previous_depth) > -kRounding;
      }
      previous = std::exchange(t, twin / 3);
      previous_depth = depth;
    }
    return false;
  }

  Canvas& canvas_;
  std::span<const std::uint32_t> twins_;
  std::span<const ParameterTriangle> triangles_;
  const QuadtreeLeaves& leaves_;
  std::span<std::uint32_t> under_;
  const ExecutionContext& context_;
  std::uint64_t sections_ = 0, texels_ = 0;
  std::atomic<std::uint64_t> walked_ = 0, searched_ = 0;
};

}  // namespace

IdBuffer::IdBuffer(std::unique_ptr<Canvas> canvas) : canvas_(std::move(canvas)) {}
IdBuffer::~IdBuffer() = default;

absl::Status IdBuffer::check() { return load_osmesa(); }

absl::StatusOr<std::unique_ptr<IdBuffer>> IdBuffer::create() {
  absl::StatusOr<std::unique_ptr<Canvas>> canvas = Canvas::create();
  if (!canvas.ok()) return canvas.status();
  return std::unique_ptr<IdBuffer>(new IdBuffer(*std::move(canvas)));
}

absl::Status IdBuffer::locate(const Chart& chart, std::span<const ParameterTriangle> triangles, const QuadtreeLeaves& leaves,
                              std::span<std::uint32_t> under, const ExecutionContext& context, IdBufferCounts* counts) {
  if (absl::Status status = canvas_->make_current(); !status.ok()) return status;
  Locator locator(*canvas_, chart, triangles, leaves, under, context);
  absl::Status status = locator.run();
  GlContext::release_current();
  if (counts != nullptr) {
    const IdBufferCounts more = locator.counts();
    counts->sections += more.sections;
    counts->texels += more.texels;
    counts->walked += more.walked;
    counts->searched += more.searched;
  }
  return status;
}

}  // namespace curvecast
