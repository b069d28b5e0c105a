#include <absl/functional/function_ref.h>
#include <absl/status/status.h>

#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <memory>

#include "core/render/gl_context_osmesa.h"
#include "core/render/gl_functions_osmesa.h"
#include "core/render/splat_scene.h"
#include "core/render/splat_shaders.h"

namespace curvecast {
namespace {

// Of the discs, in splat radii. Small ones hide what is behind them; large ones blend, and end where their kernels sum up to what
// the small ones have at their edge: gaps and the notches of the silhouette between neighbouring discs close.
constexpr float kHidingExtent = 0.8F;
constexpr float kBlendExtent = 1.4F;
// How far behind the nearest disc others still blend, in radii along the ray.
constexpr float kBlendDepth = 0.8F;
constexpr float kBlendDepthFacing = 2.5F;  // without normals: discs that face the camera are steps, which must blend to slopes

float least_kernel() {
  const float t = 1 - kHidingExtent * kHidingExtent / (kBlendExtent * kBlendExtent);
  return 0.999F * t * t * t;
}

GLuint make_texture(GLenum internal_format, int width, int height) {
  const bool is_depth = internal_format == GL_DEPTH_COMPONENT32F;
  GLuint texture = 0;
  gl.GenTextures(1, &texture);
  gl.BindTexture(GL_TEXTURE_2D, texture);
  gl.TexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(internal_format), width, height, 0, is_depth ? GL_DEPTH_COMPONENT : GL_RGBA,
                GL_FLOAT, nullptr);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  return texture;
}

absl::StatusOr<GLuint> make_target(std::initializer_list<GLuint> colors, GLuint depth) {
  GLuint framebuffer = 0;
  gl.GenFramebuffers(1, &framebuffer);
  gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  GLenum attachments[3] = {};
  GLsizei count = 0;
  for (const GLuint color : colors) {
    attachments[count] = GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(count);
    gl.FramebufferTexture2D(GL_FRAMEBUFFER, attachments[count++], GL_TEXTURE_2D, color, 0);
  }
  gl.DrawBuffers(count, attachments);
  if (depth != 0) gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth, 0);
  if (absl::Status status = check_gl("its textures"); !status.ok()) return status;
  if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    return absl::InternalError("OSMesa cannot draw into floating-point textures");
  }
  return framebuffer;
}

void set(GLuint program, const char* name, float x) { gl.Uniform1f(gl.GetUniformLocation(program, name), x); }
void set(GLuint program, const char* name, int x) { gl.Uniform1i(gl.GetUniformLocation(program, name), x); }
void set(GLuint program, const char* name, float x, float y) { gl.Uniform2f(gl.GetUniformLocation(program, name), x, y); }

void set(GLuint program, const char* name, const std::array<float, 4>& v) {
  gl.Uniform4fv(gl.GetUniformLocation(program, name), 1, v.data());
}

// sRGB to linear light.
void set(GLuint program, const char* name, const std::array<std::uint8_t, 3>& color) {
  std::array<float, 3> linear;
  for (std::size_t i = 0; i < 3; ++i) {
    const float c = static_cast<float>(color[i]) / 255;
    linear[i] = c <= 0.04045F ? c / 12.92F : std::pow((c + 0.055F) / 1.055F, 2.4F);
  }
  gl.Uniform3fv(gl.GetUniformLocation(program, name), 1, linear.data());
}

void bind_texture(GLuint program, const char* name, int unit, GLuint texture) {
  gl.ActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  gl.BindTexture(GL_TEXTURE_2D, texture);
  set(program, name, unit);
}

struct Attribute {
  GLint components;
  GLenum type;
  std::size_t offset;
};

template <class Vertex>
absl::Status upload(const std::vector<Vertex>& vertices, std::initializer_list<Attribute> attributes, GLuint divisor) {
  GLuint array = 0, buffer = 0;
  gl.GenVertexArrays(1, &array);
  gl.BindVertexArray(array);
  gl.GenBuffers(1, &buffer);
  gl.BindBuffer(GL_ARRAY_BUFFER, buffer);
  gl.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(Vertex)), vertices.data(), GL_STATIC_DRAW);
  GLuint index = 0;
  for (const Attribute& a : attributes) {
    gl.EnableVertexAttribArray(index);
    gl.VertexAttribPointer(index, a.components, a.type, a.type == GL_UNSIGNED_BYTE, sizeof(Vertex),
                           reinterpret_cast<const void*>(a.offset));
    gl.VertexAttribDivisor(index++, divisor);
  }
  return check_gl("its vertices");
}

// One picture: the textures that its passes hand on to each other.
class Passes {
 public:
  explicit Passes(const SplatScene& scene)
      : scene_(scene), samples_x_(scene.width * scene.supersample), samples_y_(scene.height * scene.supersample) {
    const float near = scene.z_near, far = scene.z_far;
    projection_ = {1 / scene.tan_half_x, -1 / scene.tan_half_y, -(far + near) / (far - near), -2 * far * near / (far - near)};
    samples_per_unit_ = static_cast<float>(samples_y_) / (2 * scene.tan_half_y);
  }

  // Depths and sums of the splats.
  absl::Status splat() {
    const int w = samples_x_, h = samples_y_;
    const GLuint depth = make_texture(GL_DEPTH_COMPONENT32F, w, h);
    normals_ = make_texture(GL_RGBA32F, w, h);
    depths_ = make_texture(GL_RG32F, w, h);
    if (scene_.has_colors) colors_ = make_texture(GL_RGBA16F, w, h);
    const absl::StatusOr<GLuint> target =
        scene_.has_colors ? make_target({normals_, depths_, colors_}, depth) : make_target({normals_, depths_}, depth);
    if (!target.ok()) return target.status();
    absl::Status status = upload(scene_.splats,
                                 {{4, GL_FLOAT, offsetof(SplatVertex, center)},
                                  {3, GL_FLOAT, offsetof(SplatVertex, normal)},
                                  {4, GL_UNSIGNED_BYTE, offsetof(SplatVertex, color)}},
                                 1);
    if (!status.ok()) return status;
    gl.Viewport(0, 0, w, h);
    gl.ClearColor(0, 0, 0, 0);
    gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);

    gl.Enable(GL_DEPTH_TEST);
    gl.ColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    status = draw_discs({kDepthFragmentShader}, kHidingExtent, scene_.has_normals ? kBlendDepth : kBlendDepthFacing);
    if (!status.ok()) return status;

    gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    gl.DepthMask(GL_FALSE);
    gl.Enable(GL_BLEND);
    gl.BlendFunc(GL_ONE, GL_ONE);
    const char* const version = scene_.has_colors ? "#version 330 core\n#define HAS_COLORS\n" : "#version 330 core\n";
    status = draw_discs({version, kBlendFragmentShader}, kBlendExtent, 0);
    gl.Disable(GL_BLEND);
    gl.Disable(GL_DEPTH_TEST);
    return status;
  }

  absl::Status occlude() {
    if (!scene_.ambient_occlusion) return absl::OkStatus();
    const GLuint pixel_depths = make_texture(GL_R32F, scene_.width, scene_.height);
    const GLuint rough = make_texture(GL_R32F, scene_.width, scene_.height);
    occlusions_ = make_texture(GL_R32F, scene_.width, scene_.height);
    absl::Status status = draw_screen(pixel_depths, kPixelDepthFragmentShader, {});
    if (status.ok()) status = draw_screen(rough, kOcclusionFragmentShader, {{"pixel_depths", pixel_depths}});
    if (status.ok()) {
      status = draw_screen(occlusions_, kSmoothFragmentShader, {{"pixel_depths", pixel_depths}, {"occlusions", rough}});
    }
    return status;
  }

  absl::Status shade() {
    const GLuint picture = make_texture(GL_RGBA8, scene_.width, scene_.height);
    return draw_screen(picture, kShadeFragmentShader, {{"colors", colors_}, {"occlusions", occlusions_}}, [this](GLuint program) {
      set(program, "has_colors", scene_.has_colors);
      set(program, "has_occlusion", scene_.ambient_occlusion);
      set(program, "is_matte", scene_.is_matte);
      set(program, "surface_color", scene_.surface_color);
      set(program, "background_top", scene_.background_top);
      set(program, "background_bottom", scene_.background_bottom);
      set(program, "height", static_cast<float>(scene_.height));
    });
  }

  // Over the shaded picture.
  absl::Status dot() {
    if (scene_.dots.empty()) return absl::OkStatus();
    const absl::StatusOr<GLuint> program = link_gl_program(kDotVertexShader, {kDotFragmentShader});
    if (!program.ok()) return program.status();
    absl::Status status =
        upload(scene_.dots, {{3, GL_FLOAT, offsetof(DotVertex, center)}, {4, GL_UNSIGNED_BYTE, offsetof(DotVertex, color)}}, 0);
    if (!status.ok()) return status;
    bind_texture(*program, "normals", 0, normals_);
    bind_texture(*program, "depths", 1, depths_);
    set(*program, "projection", projection_);
    set(*program, "diameter", scene_.dot_diameter);
    set(*program, "least_kernel", least_kernel());
    set(*program, "tolerance", kBlendDepth * scene_.mean_radius);
    gl.Enable(GL_PROGRAM_POINT_SIZE);
    gl.Enable(GL_BLEND);
    gl.BlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);
    gl.DrawArrays(GL_POINTS, 0, static_cast<GLsizei>(scene_.dots.size()));
    gl.Disable(GL_BLEND);
    return check_gl("the pass for the dots");
  }

  absl::StatusOr<Image> read() const {
    Image image{scene_.width, scene_.height, {}};
    image.rgba.resize(4 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
    gl.ReadPixels(0, 0, image.width, image.height, GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
    if (absl::Status status = check_gl("reading the picture"); !status.ok()) return status;
    return image;
  }

 private:
  absl::Status draw_discs(std::initializer_list<const char*> fragment_shader, float extent, float back_shift) const {
    const absl::StatusOr<GLuint> program = link_gl_program(kSplatVertexShader, fragment_shader);
    if (!program.ok()) return program.status();
    set(*program, "projection", projection_);
    set(*program, "back_shift", back_shift);
    set(*program, "extent", extent);
    // Half the diagonal of a sample's square: a disc of this radius holds a sample wherever it lies.
    set(*program, "min_extent", 0.7072F / kHidingExtent / samples_per_unit_);
    gl.DrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(scene_.splats.size()));
    return check_gl("a pass over the splats");
  }

  struct Input {
    const char* name;
    GLuint texture;
  };

  // One value per pixel into `output`, from the surface's samples and the inputs.
  absl::Status draw_screen(
      GLuint output, const char* shader, std::initializer_list<Input> inputs,
      absl::FunctionRef<void(GLuint)> set_more = [](GLuint) {}) const {
    if (const absl::StatusOr<GLuint> target = make_target({output}, 0); !target.ok()) return target.status();
    const absl::StatusOr<GLuint> linked = link_gl_program(kScreenVertexShader, {kSurfaceFunctions, shader});
    if (!linked.ok()) return linked.status();
    const GLuint program = *linked;
    bind_texture(program, "normals", 0, normals_);
    bind_texture(program, "depths", 1, depths_);
    int unit = 2;
    for (const Input& input : inputs) bind_texture(program, input.name, unit++, input.texture);
    const float x = 2 * scene_.tan_half_x / static_cast<float>(samples_x_);
    const float y = -2 * scene_.tan_half_y / static_cast<float>(samples_y_);
    set(program, "ray_scale", x, y);
    set(program, "ray_offset", 0.5F * x - scene_.tan_half_x, 0.5F * y + scene_.tan_half_y);
    set(program, "supersample", scene_.supersample);
    set(program, "has_normals", scene_.has_normals);
    set(program, "mean_radius", scene_.mean_radius);
    set(program, "samples_per_unit", samples_per_unit_);
    set(program, "least_kernel", least_kernel());
    set_more(program);
    gl.Viewport(0, 0, scene_.width, scene_.height);
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
    return check_gl("a pass over the picture");
  }

  const SplatScene& scene_;
  const int samples_x_, samples_y_;
  std::array<float, 4> projection_;
  float samples_per_unit_;
  GLuint normals_ = 0, depths_ = 0, colors_ = 0, occlusions_ = 0;
};

}  // namespace

absl::StatusOr<Image> draw_splats(const SplatScene& scene) {
  const absl::StatusOr<std::unique_ptr<GlContext>> context = GlContext::create();
  if (!context.ok()) return context.status();
  Passes passes(scene);
  if (absl::Status status = passes.splat(); !status.ok()) return status;
  if (absl::Status status = passes.occlude(); !status.ok()) return status;
  if (absl::Status status = passes.shade(); !status.ok()) return status;
  if (absl::Status status = passes.dot(); !status.ok()) return status;
  return passes.read();
}

}  // namespace curvecast
