// What every use of OSMesa needs: a context of its own, programs, errors in words. Names of GL objects are plain numbers here.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <initializer_list>
#include <memory>

struct osmesa_context;

namespace curvecast {

/// An OpenGL 3.3 core context with a token buffer of one pixel: everything is drawn into textures. It owns what is made in it.
/// Thread-compatible; GL's calls go to the context that is current on the calling thread.
class GlContext {
 public:
  /// Current on this thread. Unimplemented where there is no OSMesa, Unavailable when it gives none.
  static absl::StatusOr<std::unique_ptr<GlContext>> create();
  /// Makes it current on the calling thread. Precondition: it is not current on another one.
  absl::Status make_current();
  /// Leaves this thread without a context.
  static void release_current();

 private:
  struct Deleter {
    void operator()(osmesa_context* context) const;
  };

  std::uint8_t buffer_[4] = {};
  std::unique_ptr<osmesa_context, Deleter> context_;
};

/// Checks whether GL has failed since the last check, `what` it was doing then. ResourceExhausted: not enough memory; else
/// Internal.
absl::Status check_gl(const char* what);

/// Compiles and links a program and makes it current; the fragment shader may come in several parts.
absl::StatusOr<unsigned> link_gl_program(const char* vertex, std::initializer_list<const char*> fragment);

}  // namespace curvecast
