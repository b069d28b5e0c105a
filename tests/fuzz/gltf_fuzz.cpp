#include "tests/fuzz/fuzz_mesh.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return curvecast::fuzzing::fuzz_mesh(curvecast::MeshFormat::kGltf, "a.gltf", data, size);
}
