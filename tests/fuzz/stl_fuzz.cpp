#include "tests/fuzz/fuzz_mesh.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return curvecast::fuzzing::fuzz_mesh(curvecast::MeshFormat::kStl, "a.stl", data, size);
}
