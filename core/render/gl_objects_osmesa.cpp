#include "core/render/gl_objects_osmesa.h"

#include <absl/status/status.h>

#include <cmath>
#include <cstddef>

#include "core/render/gl_context_osmesa.h"

namespace curvecast {

GLuint make_texture(GLenum internal_format, int width, int height) {
  const bool is_depth = internal_format == GL_DEPTH_COMPONENT32F, is_number = internal_format == GL_R32UI;
  const GLenum format = is_depth ? GL_DEPTH_COMPONENT : is_number ? GL_RED_INTEGER : GL_RGBA;
  GLuint texture = 0;
  gl.GenTextures(1, &texture);
  gl.BindTexture(GL_TEXTURE_2D, texture);
  gl.TexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(internal_format), width, height, 0, format,
                is_number ? GL_UNSIGNED_INT : GL_FLOAT, nullptr);
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
    return absl::InternalError("OSMesa cannot draw into textures of these numbers");
  }
  return framebuffer;
}

void set(GLuint program, const char* name, float x) { gl.Uniform1f(gl.GetUniformLocation(program, name), x); }
void set(GLuint program, const char* name, int x) { gl.Uniform1i(gl.GetUniformLocation(program, name), x); }
void set(GLuint program, const char* name, float x, float y) { gl.Uniform2f(gl.GetUniformLocation(program, name), x, y); }
void set(GLuint program, const char* name, const std::array<float, 2>& v) { set(program, name, v[0], v[1]); }

void set(GLuint program, const char* name, const std::array<float, 4>& v) {
  gl.Uniform4fv(gl.GetUniformLocation(program, name), 1, v.data());
}

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

}  // namespace curvecast
