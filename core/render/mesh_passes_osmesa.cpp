#include <absl/status/status.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/for_all.h"
#include "core/render/gl_context_osmesa.h"
#include "core/render/mesh_scene.h"
#include "core/render/surface_passes_osmesa.h"

namespace curvecast {
namespace {

constexpr std::size_t kTriangles = 1 << 16;  // of a chunk: 2.4 MB of corners
constexpr std::size_t kGrain = 4096;         // triangles, or samples, of one piece of work
constexpr std::size_t kSamples = 1 << 18;    // of a band of the picture: 9 MB of what is seen there
// Of a face seen more from the side than this (a cosine), a sample's share is taken to be no larger.
constexpr double kLeastFacing = 0.02;

constexpr char kVertexShader[] = R"(#version 330 core
layout(location = 0) in vec3 place;
uniform vec4 projection;
void main() {
  gl_Position = vec4(projection.xy * place.xy, projection.z * place.z + projection.w, -place.z);
}
)";
constexpr char kFragmentShader[] = R"(#version 330 core
uniform uint first;
layout(location = 0) out uint number;
void main() { number = first + uint(gl_PrimitiveID); }
)";

using Corner = std::array<float, 3>;  // in eye space

/// What is seen at samples, as SurfacePasses wants it.
struct Band {
  std::vector<std::uint32_t> numbers;  // of triangles, from 1 on; 0: nothing
  std::vector<std::array<float, 4>> normals, colors;
  std::vector<std::array<float, 2>> depths;

  Band(std::size_t samples, bool has_colors)
      : numbers(samples), normals(samples), colors(has_colors ? samples : 0), depths(samples) {}
};

class MeshPasses {
 public:
  MeshPasses(const MeshScene& scene, const ExecutionContext& context) : scene_(scene), context_(context), surface_(scene, 0.5F) {}

  absl::StatusOr<Image> draw() {
    if (absl::Status status = draw_numbers(); !status.ok()) return status;
    if (absl::Status status = look_at_samples(); !status.ok()) return status;
    if (absl::Status status = surface_.occlude(); !status.ok()) return status;
    if (absl::Status status = context_.check(); !status.ok()) return status;
    if (absl::Status status = surface_.shade(); !status.ok()) return status;
    return surface_.read();
  }

 private:
  /// Binds a target with the number of the triangle that is seen at each sample.
  absl::Status draw_numbers() {
    const GLuint numbers = make_texture(GL_R32UI, surface_.width, surface_.height);
    const absl::StatusOr<GLuint> target =
        make_target({numbers}, make_texture(GL_DEPTH_COMPONENT32F, surface_.width, surface_.height));
    if (!target.ok()) return target.status();
    numbers_target_ = *target;
    const absl::StatusOr<GLuint> program = link_gl_program(kVertexShader, {kFragmentShader});
    if (!program.ok()) return program.status();
    set(*program, "projection", surface_.projection);
    const GLint first = gl.GetUniformLocation(*program, "first");
    GLuint array = 0, buffer = 0;
    gl.GenVertexArrays(1, &array);
    gl.BindVertexArray(array);
    gl.GenBuffers(1, &buffer);
    gl.BindBuffer(GL_ARRAY_BUFFER, buffer);
    gl.EnableVertexAttribArray(0);
    gl.VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(Corner), nullptr);
    constexpr GLuint kNothing[4] = {};
    gl.Viewport(0, 0, surface_.width, surface_.height);
    gl.ClearBufferuiv(GL_COLOR, 0, kNothing);
    gl.Clear(GL_DEPTH_BUFFER_BIT);
    gl.Enable(GL_DEPTH_TEST);
    const std::size_t count = scene_.mesh.triangles.size();
    std::vector<Corner> corners(3 * std::min(count, kTriangles));
    for (std::size_t begin = 0; begin < count; begin += kTriangles) {
      const std::size_t size = std::min(kTriangles, count - begin);
      place_corners(begin, size, corners);
      if (absl::Status status = context_.check(); !status.ok()) return status;
      gl.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(3 * size * sizeof(Corner)), corners.data(), GL_STREAM_DRAW);
      gl.Uniform1ui(first, static_cast<GLuint>(begin + 1));
      gl.DrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(3 * size));
      gl.Finish();  // else OSMesa keeps the corners of many chunks, and what it has made of them
      if (absl::Status status = check_gl("the triangles"); !status.ok()) return status;
    }
    gl.Disable(GL_DEPTH_TEST);
    return absl::OkStatus();
  }

  /// Isolated, as all work here: while it waits this thread must not take up other work that draws, in a context of its own.
  void place_corners(std::size_t begin, std::size_t size, std::vector<Corner>& corners) const {
    tbb::this_task_arena::isolate([&] {
      for_blocks(context_, size, kGrain, [&](std::size_t from, std::size_t to) {
        for (std::size_t t = from; t < to; ++t) {
          const Triangle& triangle = scene_.mesh.triangles[begin + t];
          for (std::size_t i = 0; i < 3; ++i) {
            corners[3 * t + i] = to_floats(scene_.space.place(scene_.mesh.positions[triangle[i]]));
          }
        }
      });
    });
  }

  /// Fills the textures of the surface, band by band, from the numbers.
  absl::Status look_at_samples() {
    surface_.make_textures();
    const auto width = static_cast<std::size_t>(surface_.width);
    const int rows = static_cast<int>(std::clamp<std::size_t>(kSamples / width, 1, static_cast<std::size_t>(surface_.height)));
    Band band(static_cast<std::size_t>(rows) * width, scene_.has_colors);
    gl.BindFramebuffer(GL_FRAMEBUFFER, numbers_target_);
    for (int row = 0; row < surface_.height; row += rows) {
      const int height = std::min(rows, surface_.height - row);
      gl.ReadPixels(0, row, surface_.width, height, GL_RED_INTEGER, GL_UNSIGNED_INT, band.numbers.data());
      tbb::this_task_arena::isolate([&] {
        for_blocks(context_, static_cast<std::size_t>(height) * width, kGrain, [&](std::size_t begin, std::size_t end) {
          for (std::size_t s = begin; s < end; ++s) look(s % width, static_cast<std::size_t>(row) + s / width, s, band);
        });
      });
      if (absl::Status status = context_.check(); !status.ok()) return status;
      const auto write = [&](GLuint texture, GLenum format, const void* data) {
        gl.BindTexture(GL_TEXTURE_2D, texture);
        gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, row, surface_.width, height, format, GL_FLOAT, data);
      };
      write(surface_.normals, GL_RGBA, band.normals.data());
      write(surface_.depths, GL_RG, band.depths.data());
      if (scene_.has_colors) write(surface_.colors, GL_RGBA, band.colors.data());
      if (absl::Status status = check_gl("what is seen of the triangles"); !status.ok()) return status;
    }
    return absl::OkStatus();
  }

  /// Computes what is seen at the sample in this column and row of the picture, entry s of the band.
  void look(std::size_t column, std::size_t row, std::size_t s, Band& band) const {
    band.normals[s] = {};
    band.depths[s] = {};
    if (band.numbers[s] == 0) return;
    const std::uint32_t face = band.numbers[s] - 1;
    const Triangle& triangle = scene_.mesh.triangles[face];
    const Vec3d ray(static_cast<double>(column) * surface_.ray_scale[0] + surface_.ray_offset[0],
                    static_cast<double>(row) * surface_.ray_scale[1] + surface_.ray_offset[1], -1);
    std::array<Vec3d, 3> corners;
    std::array<Vec2d, 3> beside;  // of the corners, from the ray at their depth
    for (std::size_t i = 0; i < 3; ++i) {
      corners[i] = scene_.space.place(scene_.mesh.positions[triangle[i]]);
      beside[i] = corners[i].head<2>() + corners[i].z() * ray.head<2>();
    }
    // Where the ray meets the face's plane: the volume that eye and ray span with each side, over all of them.
    const auto cross = [](const Vec2d& a, const Vec2d& b) { return a.x() * b.y() - a.y() * b.x(); };
    Vec3d weights(cross(beside[1], beside[2]), cross(beside[2], beside[0]), cross(beside[0], beside[1]));
    weights = (weights / weights.sum()).cwiseMax(0.0);  // OSMesa, in its precision, sees a little beyond the sides
    weights = std::isfinite(weights.sum()) && weights.sum() > 0 ? Vec3d(weights / weights.sum()) : Vec3d::Constant(1.0 / 3);
    const double depth = -(weights[0] * corners[0].z() + weights[1] * corners[1].z() + weights[2] * corners[2].z());

    const Vec3d plane = (corners[1] - corners[0]).cross(corners[2] - corners[0]).stableNormalized();
    const double facing = std::max(std::abs(plane.dot(ray)), kLeastFacing);
    const double side = depth / scene_.space.scale;
    const double area = std::abs(double{surface_.ray_scale[0]} * surface_.ray_scale[1]) * side * side / facing;
    const SurfaceLook look = scene_.mesh.look(face, weights.cast<float>(), area);
    const std::array<float, 3> normal = to_floats(scene_.space.direction(look.normal));
    band.normals[s] = {normal[0], normal[1], normal[2], 1};
    band.depths[s] = {static_cast<float>(depth), 1};
    if (!scene_.has_colors) return;
    const auto light = [](std::uint8_t value) { return static_cast<float>(value * value) / (255.0F * 255.0F); };
    band.colors[s] = {light(look.color[0]), light(look.color[1]), light(look.color[2]), 1};
  }

  const MeshScene& scene_;
  const ExecutionContext& context_;
  SurfacePasses surface_;
  GLuint numbers_target_ = 0;
};

}  // namespace

absl::StatusOr<Image> draw_mesh(const MeshScene& scene, const ExecutionContext& context) {
  const absl::StatusOr<std::unique_ptr<GlContext>> gl_context = GlContext::create();
  if (!gl_context.ok()) return gl_context.status();
  return MeshPasses(scene, context).draw();
}

}  // namespace curvecast
