// Writes what the fuzzers start from, for each into a folder of its own: the good and the hostile files of the tests, and the
// seeds of fuzz_seeds.h.
#include <array>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>

#include "core/mesh_io/mesh_io.h"
#include "tests/fuzz/fuzz_mesh.h"
#include "tests/fuzz/fuzz_seeds.h"
#include "tests/support/hostile_files.h"
#include "tests/support/mesh_samples.h"

namespace {

using curvecast::MeshFormat;
using Companions = std::map<std::string, std::string, std::less<>>;

constexpr std::array<const char*, 6> kFolders = {"ply", "obj", "off", "stl", "gltf", "3mf"};  // by MeshFormat

class Corpus {
 public:
  explicit Corpus(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// As one input: see kMark.
  void add_mesh(const std::string& name, const std::string& bytes, const Companions& companions) {
    const absl::StatusOr<MeshFormat> format = curvecast::detect_mesh_format(name, bytes);
    std::string input = bytes;
    Companions asked;
    const auto companion = [&](std::string_view wanted) -> std::optional<std::span<const char>> {
      const auto found = companions.find(wanted);
      if (found == companions.end()) return std::nullopt;
      if (asked.emplace(wanted, "").second) input.append(curvecast::fuzzing::kMark).append(found->second);
      return std::span<const char>(found->second);
    };
    static_cast<void>(curvecast::read_mesh({.name = name, .bytes = bytes, .companion = companion}));
    if (format.ok()) add(kFolders.at(static_cast<std::size_t>(*format)), input);
    for (const auto& [companion_name, picture] : companions) {
      if (picture.find("PNG") == 1 || picture.starts_with("\xff\xd8") || picture.starts_with("RIFF")) add("texture", picture);
    }
  }
  bool good() const { return good_; }

  void add(const std::string& target, const std::string& input) {
    std::filesystem::create_directories(folder_ / target);
    std::ofstream file(folder_ / target / std::to_string(count_++), std::ios::binary);
    file << input;
    good_ = good_ && file.flush().good();
  }

 private:
  std::filesystem::path folder_;
  int count_ = 0;
  bool good_ = true;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "Usage: fuzz_corpus FOLDER\n";
    return 2;
  }
  Corpus corpus(argv[1]);
  for (const auto& sample : curvecast::testing::mesh_samples()) corpus.add_mesh(sample.name, sample.bytes, sample.companions);
  for (const auto& hostile : curvecast::testing::hostile_files())
    corpus.add_mesh(hostile.name, hostile.bytes, hostile.companions);
  for (const auto& [target, input] : curvecast::fuzzing::seeds()) corpus.add(target, input);
  return corpus.good() ? 0 : 1;
}
