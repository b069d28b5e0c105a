#include "tests/fuzz/section_sums.h"

#include <xxhash.h>

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "core/storage/section_file.h"
#include "server/base/hash.h"

namespace curvecast::fuzzing {
namespace {

// Offsets in a section file's header, and sizes.
constexpr std::size_t kHeader = 64, kEntry = 64, kSum = 8, kAlignment = 64;
constexpr std::size_t kFileSize = 24, kSections = 32, kBlocks = 40, kChecksum = 56;
// Those of a mesh file's trailer.
constexpr std::size_t kTrailer = 40, kMeshSize = 0, kNameSize = 8, kSenderSize = 16, kTextSum = 24;

std::uint64_t number_at(const std::string& file, std::size_t offset) {
  std::uint64_t number = 0;
  std::memcpy(&number, file.data() + offset, sizeof number);
  return number;
}

void set_number(std::string& file, std::size_t offset, std::uint64_t number) {
  std::memcpy(file.data() + offset, &number, sizeof number);
}

}  // namespace

void mend_section_file(std::string& file) {
  if (file.size() < kHeader) return;
  set_number(file, kFileSize, file.size());
  const std::uint64_t sections = number_at(file, kSections), blocks = number_at(file, kBlocks);
  if (sections > file.size() / kEntry || blocks > file.size() / kSum) return;
  const std::size_t sums = kHeader + sections * kEntry;
  const std::size_t begin = (sums + blocks * kSum + kAlignment - 1) / kAlignment * kAlignment;
  if (begin > file.size() || (file.size() - begin + kSectionFileBlock - 1) / kSectionFileBlock != blocks) return;
  for (std::uint64_t i = 0; i < blocks; ++i) {
    const std::size_t at = begin + i * kSectionFileBlock;
    const std::size_t size = std::min<std::size_t>(kSectionFileBlock, file.size() - at);
    set_number(file, sums + i * kSum, XXH3_64bits(file.data() + at, size));
  }
  set_number(file, kChecksum, 0);
  const std::uint64_t seed = XXH3_64bits(file.data(), kHeader);
  set_number(file, kChecksum, XXH3_64bits_withSeed(file.data() + kHeader, begin - kHeader, seed));
}

std::string mend_mesh_file(std::string& file) {
  server::Hasher hasher;
  if (file.size() < kTrailer) return hasher.hex();
  const std::size_t trailer = file.size() - kTrailer;
  const std::uint64_t sizes[] = {number_at(file, trailer + kMeshSize), number_at(file, trailer + kNameSize),
                                 number_at(file, trailer + kSenderSize)};
  if (sizes[0] > trailer || sizes[1] + sizes[2] != trailer - sizes[0]) return hasher.hex();
  const std::uint64_t seed = XXH3_64bits(sizes, sizeof sizes);
  set_number(file, trailer + kTextSum, XXH3_64bits_withSeed(file.data() + sizes[0], trailer - sizes[0], seed));
  hasher.update({file.data(), sizes[0]});
  return hasher.hex();
}

}  // namespace curvecast::fuzzing
