#include <absl/status/status.h>

#include <cstddef>
#include <initializer_list>
#include <memory>
#include <vector>

#include "core/render/gl_context_osmesa.h"
#include "core/render/gl_objects_osmesa.h"
#include "core/render/splat_scene.h"
#include "core/render/splat_shaders.h"
#include "core/render/surface_passes_osmesa.h"

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

// The passes that only splats need.
class Passes {
 public:
  explicit Passes(const SplatScene& scene) : scene_(scene), surface_(scene, least_kernel()) {}

  absl::StatusOr<Image> draw() {
    if (absl::Status status = splat(); !status.ok()) return status;
    if (absl::Status status = surface_.occlude(); !status.ok()) return status;
    if (absl::Status status = surface_.shade(); !status.ok()) return status;
    if (absl::Status status = dot(); !status.ok()) return status;
    return surface_.read();
  }

 private:
  // Depths and sums of the splats.
  absl::Status splat() {
    const GLuint depth = make_texture(GL_DEPTH_COMPONENT32F, surface_.width, surface_.height);
    surface_.make_textures();
    const absl::StatusOr<GLuint> target = scene_.has_colors
                                              ? make_target({surface_.normals, surface_.depths, surface_.colors}, depth)
                                              : make_target({surface_.normals, surface_.depths}, depth);
    if (!target.ok()) return target.status();
    absl::Status status = upload(scene_.splats,
                                 {{4, GL_FLOAT, offsetof(SplatVertex, center)},
                                  {3, GL_FLOAT, offsetof(SplatVertex, normal)},
                                  {4, GL_UNSIGNED_BYTE, offsetof(SplatVertex, color)},
                                  {4, GL_FLOAT, offsetof(SplatVertex, ends)},
                                  {4, GL_FLOAT, offsetof(SplatVertex, ends) + sizeof(SplatVertex{}.ends[0])}},
                                 1);
    if (!status.ok()) return status;
    gl.Viewport(0, 0, surface_.width, surface_.height);
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

  // Over the shaded picture.
  absl::Status dot() {
    if (scene_.dots.empty()) return absl::OkStatus();
    const absl::StatusOr<GLuint> program = link_gl_program(kDotVertexShader, {kDotFragmentShader});
    if (!program.ok()) return program.status();
    absl::Status status =
        upload(scene_.dots, {{3, GL_FLOAT, offsetof(DotVertex, center)}, {4, GL_UNSIGNED_BYTE, offsetof(DotVertex, color)}}, 0);
    if (!status.ok()) return status;
    bind_texture(*program, "normals", 0, surface_.normals);
    bind_texture(*program, "depths", 1, surface_.depths);
    set(*program, "projection", surface_.projection);
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

  absl::Status draw_discs(std::initializer_list<const char*> fragment_shader, float extent, float back_shift) const {
    const absl::StatusOr<GLuint> program = link_gl_program(kSplatVertexShader, fragment_shader);
    if (!program.ok()) return program.status();
    set(*program, "projection", surface_.projection);
    set(*program, "back_shift", back_shift);
    set(*program, "extent", extent);
    // Half the diagonal of a sample's square: a disc of this radius holds a sample wherever it lies.
    set(*program, "min_extent", 0.7072F / kHidingExtent / surface_.samples_per_unit);
    gl.DrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(scene_.splats.size()));
    return check_gl("a pass over the splats");
  }

  const SplatScene& scene_;
  SurfacePasses surface_;
};

}  // namespace

absl::StatusOr<Image> draw_splats(const SplatScene& scene) {
  const absl::StatusOr<std::unique_ptr<GlContext>> context = GlContext::create();
  if (!context.ok()) return context.status();
  return Passes(scene).draw();
}

}  // namespace curvecast
