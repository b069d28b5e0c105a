#include "core/storage/section_file.h"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <cstring>
#include <filesystem>
#include <functional>
#include <numeric>

#include "tests/support/temporary_folder.h"

namespace curvecast {
namespace {

using testing::bytes_of;
using ::testing::ElementsAre;
using ::testing::ElementsAreArray;
using ::testing::HasSubstr;
using testing::TemporaryFolder;
using testing::write_file;
using Code = absl::StatusCode;

constexpr FileKind kKind = {"TEST", 3};
constexpr std::size_t kHead = 64 + 3 * 64 + 64;  // bytes before the sections: header, table, one checksum

class SectionFileTest : public ::testing::TestWithParam<FileAccess> {
 protected:
  SectionFileTest() {
    std::iota(numbers_.begin(), numbers_.end(), 1);
    const std::vector<Section> sections = {make_section("numbers", numbers_), make_section("nothing", nothing_),
                                           make_section("text", text_)};
    EXPECT_TRUE(write_section_file(path_, kKind, sections).ok());
    bytes_ = bytes_of(path_);
  }

  /// Lazily opened files are checked here as a whole.
  absl::StatusOr<std::shared_ptr<const SectionFile>> open(const std::string& path) {
    auto file = SectionFile::open(path, kKind, GetParam());
    if (!file.ok() || GetParam() != FileAccess::kMapLazily) return file;
    const auto numbers = (*file)->section<std::uint32_t>("numbers");
    if (!numbers.ok()) return file;
    const absl::Status checked = (*file)->check(*numbers);
    return checked.ok() ? file : checked;
  }
  /// What opening a file of these bytes says.
  absl::Status open_bytes(const std::string& bytes) {
    write_file(path_, bytes);
    return open(path_).status();
  }
  /// The good bytes with 8 bytes of header or table set, and the header's checksum right again.
  std::string forged(std::size_t offset, std::uint64_t value) const {
    std::string bytes = bytes_;
    std::memcpy(bytes.data() + offset, &value, sizeof value);
    std::memset(bytes.data() + 56, 0, 8);
    const std::uint64_t checksum = XXH3_64bits_withSeed(bytes.data() + 64, kHead - 64, XXH3_64bits(bytes.data(), 64));
    std::memcpy(bytes.data() + 56, &checksum, sizeof checksum);
    return bytes;
  }

  TemporaryFolder folder_;
  const std::string path_ = folder_ / "file";
  std::vector<std::uint32_t> numbers_ = std::vector<std::uint32_t>(37);
  std::vector<double> nothing_;
  std::string text_ = "some text";
  std::string bytes_;
};
INSTANTIATE_TEST_SUITE_P(Access, SectionFileTest, ::testing::Values(FileAccess::kMap, FileAccess::kMapLazily, FileAccess::kCopy));

TEST_P(SectionFileTest, BringsSectionsBackAligned) {
  const auto file = open(path_);
  ASSERT_TRUE(file.ok()) << file.status();
  const auto numbers = (*file)->section<std::uint32_t>("numbers");
  ASSERT_TRUE(numbers.ok());
  EXPECT_THAT(*numbers, ElementsAreArray(numbers_));
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(numbers->data()) % 64, 0u);
  EXPECT_TRUE((*file)->section<double>("nothing")->empty());
  const auto text = (*file)->section<char>("text");
  EXPECT_EQ(std::string(text->begin(), text->end()), text_);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(text->data()) % 64, 0u);
  EXPECT_EQ((*file)->section<std::uint16_t>("numbers").status().code(), Code::kDataLoss);
  EXPECT_EQ((*file)->section<std::uint32_t>("number").status().code(), Code::kDataLoss);
  EXPECT_EQ((*file)->size(), bytes_.size());
}

TEST_P(SectionFileTest, TheFileLivesOnWhenItIsReplacedOrRemoved) {
  const auto file = open(path_);
  ASSERT_TRUE(file.ok());
  ASSERT_TRUE(write_section_file(path_, kKind, {}).ok());
  std::filesystem::remove(path_);
  EXPECT_THAT(*(*file)->section<std::uint32_t>("numbers"), ElementsAreArray(numbers_));
}

TEST_P(SectionFileTest, SaysWhereAFileBecameShorterInUse) {
  const std::vector<std::uint64_t> much(100'000, 7);
  ASSERT_TRUE(write_section_file(path_, kKind, std::vector<Section>{make_section("much", much)}).ok());
  const auto file = SectionFile::open(path_, kKind, GetParam());
  ASSERT_TRUE(file.ok()) << file.status();
  const auto values = (*file)->section<std::uint64_t>("much");
  ASSERT_TRUE(values.ok() && (*file)->check(*values).ok());
  EXPECT_TRUE((*file)->status().ok());
  const bool is_copy = GetParam() == FileAccess::kCopy;
  const auto size = static_cast<off_t>((*file)->size());
  ASSERT_EQ(::truncate(path_.c_str(), size - 1), 0);
  EXPECT_EQ((*file)->status().code(), is_copy ? Code::kOk : Code::kDataLoss) << "which no page tells";
  ASSERT_EQ(::truncate(path_.c_str(), size), 0);
  EXPECT_TRUE((*file)->status().ok());
  ASSERT_EQ(::truncate(path_.c_str(), 100'000), 0);
  EXPECT_EQ(values->back(), is_copy ? 7u : 0u);
  EXPECT_EQ(values->front(), 7u);
  EXPECT_EQ((*file)->status().code(), is_copy ? Code::kOk : Code::kDataLoss);
  EXPECT_EQ((*file)->is_mapped(), !is_copy);
}

TEST_P(SectionFileTest, NoticesABitOfEveryByte) {
  for (std::size_t at = 0; at < bytes_.size(); ++at) {
    std::string bytes = bytes_;
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << at % 8));
    const Code code = open_bytes(bytes).code();
    EXPECT_TRUE(code == Code::kDataLoss || code == Code::kFailedPrecondition) << "byte " << at;
  }
}

TEST_P(SectionFileTest, NoticesEveryLength) {
  for (std::size_t size = 0; size < bytes_.size(); ++size) {
    EXPECT_EQ(open_bytes(bytes_.substr(0, size)).code(), Code::kDataLoss) << size;
  }
  EXPECT_EQ(open_bytes(bytes_ + '\0').code(), Code::kDataLoss);
  EXPECT_EQ(open_bytes(bytes_ + bytes_).code(), Code::kDataLoss);
}

TEST_P(SectionFileTest, RefusesForgedTables) {
  ASSERT_TRUE(open_bytes(forged(48, 0)).ok()) << "the forger works";
  const std::size_t entry = 64;  // the first: name 32, count 8, offset 8, reserved 8, element size 4, reserved 4
  for (const std::uint64_t absurd : {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{1} << 31, std::uint64_t{1} << 62,
                                     ~std::uint64_t{0}, ~std::uint64_t{0} / 4 + 1}) {
    for (const std::size_t field : {32, 40, 48, 56}) {
      if (field == 48 && absurd == 0) continue;  // as it is
      EXPECT_EQ(open_bytes(forged(entry + field, absurd)).code(), Code::kDataLoss) << field << " " << absurd;
    }
    EXPECT_EQ(open_bytes(forged(32, absurd)).code(), Code::kDataLoss) << "sections " << absurd;
    if (absurd == 1) continue;  // as it is
    EXPECT_EQ(open_bytes(forged(40, absurd)).code(), Code::kDataLoss) << "blocks " << absurd;
  }
  EXPECT_EQ(open_bytes(forged(entry, 0)).code(), Code::kDataLoss) << "no name";
  EXPECT_EQ(open_bytes(forged(entry + 64, 0x73'7265'626d'756e)).code(), Code::kDataLoss) << "one name twice";
}

TEST_P(SectionFileTest, RefusesWhatLiesBetweenSections) {
  std::string bytes = bytes_;
  bytes[kHead + 37 * 4] = 1;
  EXPECT_THAT(std::string(open_bytes(bytes).message()), HasSubstr("wrong checksum"));
}

TEST_P(SectionFileTest, ChecksLazilyWhatIsAskedFor) {
  const std::vector<std::uint64_t> much(100'000, 7), more(50'000, 8);
  ASSERT_TRUE(
      write_section_file(path_, kKind, std::vector<Section>{make_section("much", much), make_section("more", more)}).ok());
  std::string bytes = bytes_of(path_);
  bytes[bytes.size() - 100'000] ^= 1;
  write_file(path_, bytes);
  const auto file = SectionFile::open(path_, kKind, GetParam());
  if (GetParam() != FileAccess::kMapLazily) {
    EXPECT_EQ(file.status().code(), Code::kDataLoss);
    return;
  }
  ASSERT_TRUE(file.ok()) << file.status();
  const auto first = (*file)->section<std::uint64_t>("much"), second = (*file)->section<std::uint64_t>("more");
  ASSERT_TRUE(first.ok() && second.ok());
  EXPECT_TRUE((*file)->check(*first).ok());
  EXPECT_TRUE((*file)->check(second->first(10)).ok());
  EXPECT_TRUE((*file)->check(second->last(10)).ok());
  EXPECT_TRUE((*file)->check(second->first(0)).ok());
  for (int i = 0; i < 2; ++i) EXPECT_EQ((*file)->check(*second).code(), Code::kDataLoss) << "each time";
}

TEST_P(SectionFileTest, RefusesForeignFiles) {
  EXPECT_EQ(open(folder_ / "nowhere").status().code(), Code::kNotFound);
  EXPECT_EQ(open(folder_.path()).status().code(), Code::kInvalidArgument);
  EXPECT_EQ(open("/dev/zero").status().code(), Code::kInvalidArgument);
  ASSERT_EQ(::mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(open(folder_ / "pipe").status().code(), Code::kInvalidArgument);
  EXPECT_EQ(open_bytes("ply\nformat ascii 1.0\n" + std::string(1000, ' ')).code(), Code::kDataLoss);
  EXPECT_EQ(open_bytes(std::string(1000, '\0')).code(), Code::kDataLoss);
  ASSERT_EQ(::truncate(path_.c_str(), off_t{1} << 40), 0);
  EXPECT_EQ(open(path_).status().code(), Code::kDataLoss) << "a terabyte of holes";
  if (::geteuid() != 0) {  // nothing is forbidden to root
    ASSERT_EQ(::chmod(path_.c_str(), 0), 0);
    EXPECT_EQ(open(path_).status().code(), Code::kPermissionDenied);
  }
}

TEST_P(SectionFileTest, RefusesOtherKindsAndVersions) {
  for (const FileKind& kind : {FileKind{"OTHER", 3}, FileKind{"TEST", 4}}) {
    const auto file = SectionFile::open(path_, kind, GetParam());
    EXPECT_EQ(file.status().code(), Code::kFailedPrecondition);
    EXPECT_THAT(std::string(file.status().message()), HasSubstr("TEST version 3"));
  }
  EXPECT_EQ(open_bytes(forged(8, std::uint64_t{3} << 32 | 1)).code(), Code::kFailedPrecondition) << "the container's version";
}

TEST_P(SectionFileTest, AFailedWriteLeavesWhatWasThere) {
  EXPECT_FALSE(write_section_file(folder_ / "nowhere/file", kKind, {}).ok());
  std::filesystem::create_directory(folder_ / "folder");
  EXPECT_FALSE(write_section_file(folder_ / "folder", kKind, {}).ok());
  EXPECT_EQ(folder_.names().size(), 2u);
  EXPECT_TRUE(open(path_).ok());
}

}  // namespace
}  // namespace curvecast
