#include "core/render/gl_context_osmesa.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include <string>

#include "core/render/gl_functions_osmesa.h"

namespace curvecast {
namespace {

absl::Status compile(GLuint program, GLenum kind, std::initializer_list<const char*> sources) {
  const GLuint shader = gl.CreateShader(kind);
  gl.ShaderSource(shader, static_cast<GLsizei>(sources.size()), sources.begin(), nullptr);
  gl.CompileShader(shader);
  gl.AttachShader(program, shader);
  gl.DeleteShader(shader);  // lives on with the program
  GLint is_compiled = 0;
  gl.GetShaderiv(shader, GL_COMPILE_STATUS, &is_compiled);
  if (is_compiled) return absl::OkStatus();
  std::string log(4096, '\0');
  GLsizei length = 0;
  gl.GetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), &length, log.data());
  log.resize(static_cast<std::size_t>(length));
  return absl::InternalError(absl::StrCat("OSMesa cannot compile a shader: ", log));
}

}  // namespace

void GlContext::Deleter::operator()(osmesa_context* context) const {
  release_current();
  osmesa.DestroyContext(context);  // with all its textures, buffers and programs
}

absl::StatusOr<std::unique_ptr<GlContext>> GlContext::create() {
  constexpr int kAttributes[] = {OSMESA_FORMAT,
                                 OSMESA_RGBA,
                                 OSMESA_DEPTH_BITS,
                                 0,
                                 OSMESA_PROFILE,
                                 OSMESA_CORE_PROFILE,
                                 OSMESA_CONTEXT_MAJOR_VERSION,
                                 3,
                                 OSMESA_CONTEXT_MINOR_VERSION,
                                 3,
                                 0};
  if (absl::Status status = load_osmesa(); !status.ok()) return status;
  auto result = std::make_unique<GlContext>();
  result->context_.reset(osmesa.CreateContextAttribs(kAttributes, nullptr));
  if (result->context_ == nullptr) return absl::UnavailableError("OSMesa gives no OpenGL 3.3 core context");
  if (absl::Status status = result->make_current(); !status.ok()) return status;
  return result;
}

absl::Status GlContext::make_current() {
  if (osmesa.MakeCurrent(context_.get(), buffer_, GL_UNSIGNED_BYTE, 1, 1)) return absl::OkStatus();
  return absl::UnavailableError("OSMesa cannot make its context current");
}

void GlContext::release_current() { osmesa.MakeCurrent(nullptr, nullptr, 0, 0, 0); }

absl::Status check_gl(const char* what) {
  const GLenum error = gl.GetError();
  if (error == GL_NO_ERROR) return absl::OkStatus();
  if (error == GL_OUT_OF_MEMORY) {
    return absl::ResourceExhaustedError(
        absl::StrCat("OSMesa has not enough memory for ", what, "; ask for fewer pixels or points"));
  }
  return absl::InternalError(absl::StrFormat("OSMesa reports error 0x%04x from %s", error, what));
}

absl::StatusOr<unsigned> link_gl_program(const char* vertex, std::initializer_list<const char*> fragment) {
  const GLuint program = gl.CreateProgram();
  if (absl::Status status = compile(program, GL_VERTEX_SHADER, {vertex}); !status.ok()) return status;
  if (absl::Status status = compile(program, GL_FRAGMENT_SHADER, fragment); !status.ok()) return status;
  gl.LinkProgram(program);
  GLint is_linked = 0;
  gl.GetProgramiv(program, GL_LINK_STATUS, &is_linked);
  if (!is_linked) return absl::InternalError("OSMesa cannot link a shader program");
  gl.UseProgram(program);
  return program;
}

}  // namespace curvecast
