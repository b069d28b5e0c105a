// Textures, targets and uniforms of the passes that draw pictures. They go with the context that is current. Internal to
// core/render.
#pragma once

#include <absl/status/statusor.h>

#include <array>
#include <cstdint>
#include <initializer_list>

#include "core/render/gl_functions_osmesa.h"

namespace curvecast {

/// A texture without filters and levels, to be drawn into and fetched from.
GLuint make_texture(GLenum internal_format, int width, int height);

/// A framebuffer with these textures, now bound. `depth`: 0 = none.
absl::StatusOr<GLuint> make_target(std::initializer_list<GLuint> colors, GLuint depth);

void set(GLuint program, const char* name, float x);
void set(GLuint program, const char* name, int x);
void set(GLuint program, const char* name, float x, float y);
void set(GLuint program, const char* name, const std::array<float, 2>& v);
void set(GLuint program, const char* name, const std::array<float, 4>& v);
/// sRGB, to linear light.
void set(GLuint program, const char* name, const std::array<std::uint8_t, 3>& color);
void bind_texture(GLuint program, const char* name, int unit, GLuint texture);

}  // namespace curvecast
