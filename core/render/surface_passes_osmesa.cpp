#include "core/render/surface_passes_osmesa.h"

#include <cstddef>

#include "core/render/gl_context_osmesa.h"
#include "core/render/surface_shaders.h"

namespace curvecast {

SurfacePasses::SurfacePasses(const PictureScene& scene, float least_kernel)
    : width(scene.width * scene.supersample),
      height(scene.height * scene.supersample),
      scene_(scene),
      least_kernel_(least_kernel) {
  const float near = scene.z_near, far = scene.z_far;
  projection = {1 / scene.tan_half_x, -1 / scene.tan_half_y, -(far + near) / (far - near), -2 * far * near / (far - near)};
  ray_scale = {2 * scene.tan_half_x / static_cast<float>(width), -2 * scene.tan_half_y / static_cast<float>(height)};
  ray_offset = {0.5F * ray_scale[0] - scene.tan_half_x, 0.5F * ray_scale[1] + scene.tan_half_y};
  samples_per_unit = static_cast<float>(height) / (2 * scene.tan_half_y);
}

void SurfacePasses::make_textures() {
  normals = make_texture(GL_RGBA32F, width, height);
  depths = make_texture(GL_RG32F, width, height);
  if (scene_.has_colors) colors = make_texture(GL_RGBA16F, width, height);
}

absl::Status SurfacePasses::occlude() {
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

absl::Status SurfacePasses::shade() {
  const GLuint picture = make_texture(GL_RGBA8, scene_.width, scene_.height);
  return draw_screen(picture, kShadeFragmentShader, {{"colors", colors}, {"occlusions", occlusions_}}, [this](GLuint program) {
    set(program, "has_colors", scene_.has_colors);
    set(program, "has_occlusion", scene_.ambient_occlusion);
    set(program, "is_matte", scene_.is_matte);
    set(program, "surface_color", scene_.surface_color);
    set(program, "background_top", scene_.background_top);
    set(program, "background_bottom", scene_.background_bottom);
    set(program, "height", static_cast<float>(scene_.height));
  });
}

absl::StatusOr<Image> SurfacePasses::read() const {
  Image image{scene_.width, scene_.height, {}};
  image.rgba.resize(4 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  gl.ReadPixels(0, 0, image.width, image.height, GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
  if (absl::Status status = check_gl("reading the picture"); !status.ok()) return status;
  return image;
}

absl::Status SurfacePasses::draw_screen(GLuint output, const char* shader, std::initializer_list<Input> inputs,
                                        absl::FunctionRef<void(GLuint)> set_more) const {
  if (const absl::StatusOr<GLuint> target = make_target({output}, 0); !target.ok()) return target.status();
  const absl::StatusOr<GLuint> linked = link_gl_program(kScreenVertexShader, {kSurfaceFunctions, shader});
  if (!linked.ok()) return linked.status();
  const GLuint program = *linked;
  bind_texture(program, "normals", 0, normals);
  bind_texture(program, "depths", 1, depths);
  int unit = 2;
  for (const Input& input : inputs) bind_texture(program, input.name, unit++, input.texture);
  set(program, "ray_scale", ray_scale);
  set(program, "ray_offset", ray_offset);
  set(program, "supersample", scene_.supersample);
  set(program, "has_normals", scene_.has_normals);
  set(program, "mean_radius", scene_.mean_radius);
  set(program, "samples_per_unit", samples_per_unit);
  set(program, "least_kernel", least_kernel_);
  set_more(program);
  gl.Viewport(0, 0, scene_.width, scene_.height);
  gl.DrawArrays(GL_TRIANGLES, 0, 3);
  return check_gl("a pass over the picture");
}

}  // namespace curvecast
