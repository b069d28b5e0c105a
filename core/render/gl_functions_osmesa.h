// OpenGL as OSMesa has it, which is looked for when a picture is drawn for the first time: it brings LLVM, six times what all
// else takes on disk, and who draws nothing can do without it.
#pragma once

#include <absl/status/status.h>

// For the types of the functions alone; nothing is linked.
#define GL_GLEXT_PROTOTYPES
#include <GL/osmesa.h>

// Not formatted: it would make stairs of them.
// clang-format off
#define CURVECAST_GL_FUNCTIONS(X) \
  X(ActiveTexture) X(AttachShader) X(BindBuffer) X(BindFramebuffer) X(BindTexture) X(BindVertexArray) X(BlendFunc) \
  X(BlendFuncSeparate) X(BufferData) X(CheckFramebufferStatus) X(Clear) X(ClearBufferuiv) X(ClearColor) X(ColorMask) \
  X(CompileShader) X(CreateProgram) X(CreateShader) X(DeleteShader) X(DepthMask) X(Disable) X(DrawArrays) \
  X(DrawArraysInstanced) X(DrawBuffers) X(Enable) X(EnableVertexAttribArray) X(Finish) X(FramebufferTexture2D) X(GenBuffers) \
  X(GenFramebuffers) X(GenTextures) X(GenVertexArrays) X(GetError) X(GetProgramiv) X(GetShaderInfoLog) X(GetShaderiv) \
  X(GetUniformLocation) X(LinkProgram) X(ReadPixels) X(ShaderSource) X(TexImage2D) X(TexParameteri) X(TexSubImage2D) \
  X(Uniform1f) X(Uniform1i) X(Uniform1ui) X(Uniform2f) X(Uniform3fv) X(Uniform4fv) X(UseProgram) X(VertexAttribDivisor) X(VertexAttribIPointer) \
  X(VertexAttribPointer) X(Viewport)
#define CURVECAST_OSMESA_FUNCTIONS(X) X(CreateContextAttribs) X(DestroyContext) X(MakeCurrent)
// clang-format on

namespace curvecast {

/// OpenGL 3.3's functions, without their prefix.
struct GlFunctions {
#define CURVECAST_MEMBER(name) decltype(&::gl##name) name = nullptr;
  CURVECAST_GL_FUNCTIONS(CURVECAST_MEMBER)
#undef CURVECAST_MEMBER
};

/// OSMesa's own, without their prefix.
struct OsmesaFunctions {
#define CURVECAST_MEMBER(name) decltype(&::OSMesa##name) name = nullptr;
  CURVECAST_OSMESA_FUNCTIONS(CURVECAST_MEMBER)
#undef CURVECAST_MEMBER
};

/// Not to be called before load_osmesa() was OK: where there is a GlContext, it was.
extern GlFunctions gl;
extern OsmesaFunctions osmesa;

/// Loads OSMesa, once: the library that CURVECAST_OSMESA of the environment names, or Debian 12's. It stays for as long as the
/// process. Unimplemented where it is not there, or lacks a function: the message
/// says what to install. Thread-safe.
absl::Status load_osmesa();

}  // namespace curvecast
