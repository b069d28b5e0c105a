// The passes that all pictures of a surface end with: from what is seen at each sample to a shaded picture. Internal to
// core/render.
#pragma once

#include <absl/functional/function_ref.h>
#include <absl/status/statusor.h>

#include <array>
#include <initializer_list>

#include "core/base/image.h"
#include "core/render/gl_objects_osmesa.h"
#include "core/render/picture_scene.h"

namespace curvecast {

/// One picture: the textures that its passes hand on to each other. Whoever fills the first three has drawn the surface.
class SurfacePasses {
 public:
  /// `scene` must outlive it. `least_kernel`: the sum of kernels from which on a sample shows the surface, above 0.
  SurfacePasses(const PictureScene& scene, float least_kernel);

  /// Makes the textures, of width x height samples.
  void make_textures();

  /// Darkens what is closed in, where the scene wants that.
  absl::Status occlude();
  absl::Status shade();
  /// Reads the target that is bound: the picture, once it is shaded.
  absl::StatusOr<Image> read() const;

  const int width, height;          // samples
  std::array<float, 4> projection;  // x and y scale, z scale and offset
  std::array<float, 2> ray_scale;   // of a sample's column and row, to x and y at distance 1
  std::array<float, 2> ray_offset;  // of the first sample
  float samples_per_unit;           // at distance 1
  GLuint normals = 0;               // RGBA32F: sum of weighted normals; sum of kernels, 0 where there is no surface
  GLuint depths = 0;                // RG32F: sum of weighted depths; sum of weights
  GLuint colors = 0;                // RGBA16F: sum of weighted squares of sRGB values; 0 = all of the scene's colour

 private:
  struct Input {
    const char* name;
    GLuint texture;
  };

  // One value per pixel into `output`, from the surface's samples and the inputs.
  absl::Status draw_screen(
      GLuint output, const char* shader, std::initializer_list<Input> inputs,
      absl::FunctionRef<void(GLuint)> set_more = [](GLuint) {}) const;

  const PictureScene& scene_;
  const float least_kernel_;
  GLuint occlusions_ = 0;
};

}  // namespace curvecast
