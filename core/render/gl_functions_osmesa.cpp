#include "core/render/gl_functions_osmesa.h"

#include <absl/strings/str_cat.h>
#include <dlfcn.h>

#include <cstdlib>
#include <string>
#include <type_traits>

namespace curvecast {
namespace {

constexpr char kLibrary[] = "libOSMesa.so.8";  // its number is that of its interface, the same since 2012

/// The one that is looked for.
std::string osmesa_library() {
  const char* const other = std::getenv("CURVECAST_OSMESA");
  return other != nullptr && *other != '\0' ? other : kLibrary;
}

absl::Status load_from(const std::string& path) {
  // To be bound at once: a call must not end the process. Its symbols, LLVM's among them, are nobody else's.
  void* const library = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    const char* const why = ::dlerror();
    return absl::UnimplementedError(
        absl::StrCat("there is no OSMesa here, which draws pictures; install libosmesa6 (", why, ")"));
  }
  const char* missing = nullptr;
  const auto find = [&](auto& function, const char* name) {
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(::dlsym(library, name));
    if (function == nullptr) missing = name;
  };
#define CURVECAST_FIND(name) find(gl.name, "gl" #name);
  CURVECAST_GL_FUNCTIONS(CURVECAST_FIND)
#undef CURVECAST_FIND
#define CURVECAST_FIND(name) find(osmesa.name, "OSMesa" #name);
  CURVECAST_OSMESA_FUNCTIONS(CURVECAST_FIND)
#undef CURVECAST_FIND
  if (missing == nullptr) return absl::OkStatus();
  return absl::UnimplementedError(absl::StrCat(path, " lacks ", missing, ", which draws pictures"));
}

}  // namespace

GlFunctions gl;
OsmesaFunctions osmesa;

absl::Status load_osmesa() {
  static const absl::Status status = load_from(osmesa_library());
  return status;
}

}  // namespace curvecast
