#include "core/storage/section_file.h"

#include <absl/cleanup/cleanup.h>
#include <absl/strings/str_cat.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cerrno>
#include <cstring>
#include <memory>
#include <new>
#include <set>
#include <utility>
#include <vector>

#include "core/base/file_system.h"
#include "core/storage/atomic_file.h"

namespace curvecast {
namespace {

constexpr char kMagic[8] = {'\x89', 'C', 'V', 'C', '\r', '\n', '\x1a', '\n'};  // as PNG's: what damages line ends shows at once
constexpr std::uint32_t kFormatVersion = 2;
constexpr std::size_t kAlignment = 64;
constexpr std::size_t kMaxName = 31;
constexpr std::uint64_t kMaxSections = 4096;
constexpr std::uint64_t kMaxFileSize = std::uint64_t{64} << 30;
constexpr std::uint32_t kMaxElementSize = 4096;
constexpr std::uint64_t kBlocksAtOnce = 16;  // by one thread

struct Header {
  char magic[8];
  std::uint32_t format_version;
  std::uint32_t kind_version;
  char kind[8];
  std::uint64_t file_size;
  std::uint64_t sections;
  std::uint64_t blocks;
  std::uint64_t reserved;
  std::uint64_t checksum;
};
static_assert(sizeof(Header) == kAlignment);

std::uint64_t aligned(std::uint64_t offset) { return (offset + kAlignment - 1) / kAlignment * kAlignment; }

std::uint64_t hash(std::span<const std::byte> bytes) { return XXH3_64bits(bytes.data(), bytes.size()); }

struct FreeHash {
  void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
};

/// The checksums of the blocks of what is added.
class BlockSums {
 public:
  BlockSums() : state_(XXH3_createState()) {
    if (state_ == nullptr) throw std::bad_alloc();
    XXH3_64bits_reset(state_.get());
  }
  void add(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
      const std::size_t some = std::min<std::size_t>(bytes.size(), kSectionFileBlock - filled_);
      XXH3_64bits_update(state_.get(), bytes.data(), some);
      bytes = bytes.subspan(some);
      filled_ += some;
      if (filled_ == kSectionFileBlock) finish_block();
    }
  }
  std::vector<std::uint64_t> finish() {
    if (filled_ > 0) finish_block();
    return std::move(sums_);
  }

 private:
  void finish_block() {
    sums_.push_back(XXH3_64bits_digest(state_.get()));
    XXH3_64bits_reset(state_.get());
    filled_ = 0;
  }

  std::unique_ptr<XXH3_state_t, FreeHash> state_;
  std::uint64_t filled_ = 0;
  std::vector<std::uint64_t> sums_;
};

std::uint64_t size_of(const Section& section) {
  std::uint64_t size = 0;
  for (const std::span<const std::byte> part : section.parts) size += part.size();
  return size;
}

/// Of header, table and checksums, one after the other in memory; the header's own checksum counts as zero.
std::uint64_t header_hash(std::span<const std::byte> bytes) {
  Header header;
  std::memcpy(&header, bytes.data(), sizeof header);
  header.checksum = 0;
  const std::uint64_t seed = XXH3_64bits(&header, sizeof header);
  return XXH3_64bits_withSeed(bytes.data() + sizeof header, bytes.size() - sizeof header, seed);
}

/// A name as in a message, whatever is in it.
std::string word(const char* text, std::size_t size) {
  std::string out(text, strnlen(text, size));
  std::replace_if(
      out.begin(), out.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return out;
}

}  // namespace

struct SectionFile::Entry {
  char name[kMaxName + 1];  // padded with zeros
  std::uint64_t count;
  std::uint64_t offset;
  std::uint64_t reserved;
  std::uint32_t element_size;
  std::uint32_t reserved_too;
};

absl::Status write_section_file(const std::string& path, const FileKind& kind, std::span<const Section> sections) {
  struct Entry {
    char name[kMaxName + 1] = {};
    std::uint64_t count = 0, offset = 0, reserved = 0;
    std::uint32_t element_size = 0, reserved_too = 0;
  };
  static_assert(sizeof(Entry) == kAlignment);
  assert(sections.size() <= kMaxSections);
  constexpr std::byte kZeros[kAlignment] = {};
  std::uint64_t size = 0;  // of all sections
  BlockSums sums;
  // On one thread: the disk is the slower part, and the cores are for those who wait.
  for (const Section& section : sections) {
    assert(!section.name.empty() && section.name.size() <= kMaxName && size_of(section) % section.element_size == 0);
    sums.add({kZeros, aligned(size) - size});
    for (const std::span<const std::byte> part : section.parts) sums.add(part);
    size = aligned(size) + size_of(section);
  }
  const std::vector<std::uint64_t> block_sums = sums.finish();
  const std::uint64_t table_end = sizeof(Header) + sections.size() * sizeof(Entry);
  std::vector<std::byte> head(aligned(table_end + block_sums.size() * sizeof(std::uint64_t)));
  std::uint64_t end = head.size();
  for (std::size_t i = 0; i < sections.size(); ++i) {
    Entry entry;
    sections[i].name.copy(entry.name, kMaxName);
    entry.count = size_of(sections[i]) / sections[i].element_size;
    entry.offset = aligned(end);
    entry.element_size = sections[i].element_size;
    end = entry.offset + size_of(sections[i]);
    std::memcpy(head.data() + sizeof(Header) + i * sizeof entry, &entry, sizeof entry);
  }
  std::copy_n(std::as_bytes(std::span(block_sums)).data(), block_sums.size() * sizeof(std::uint64_t), head.data() + table_end);
  Header header = {};
  std::memcpy(header.magic, kMagic, sizeof kMagic);
  header.format_version = kFormatVersion;
  header.kind_version = kind.version;
  std::memcpy(header.kind, kind.name, sizeof kind.name);
  header.file_size = end;
  header.sections = sections.size();
  header.blocks = block_sums.size();
  std::memcpy(head.data(), &header, sizeof header);
  header.checksum = header_hash(head);
  std::memcpy(head.data(), &header, sizeof header);

  absl::StatusOr<AtomicFile> file = AtomicFile::create(path);
  if (!file.ok()) return file.status();
  if (absl::Status status = file->resize(end); !status.ok()) return status;
  if (absl::Status status = file->write_at(0, head); !status.ok()) return status;
  std::uint64_t offset = head.size();
  for (const Section& section : sections) {
    offset = aligned(offset);
    for (const std::span<const std::byte> part : section.parts) {
      if (absl::Status status = file->write_at(offset, part); !status.ok()) return status;
      offset += part.size();
    }
  }
  return file->commit();
}

SectionFile::~SectionFile() {
  if (data_ != nullptr && !is_mapped()) ::operator delete (const_cast<std::byte*>(data_), std::align_val_t{kAlignment});
}

absl::StatusOr<std::shared_ptr<const SectionFile>> SectionFile::open(const std::string& path, const FileKind& kind,
                                                                     FileAccess access) {
  // Without O_NONBLOCK a pipe would keep us waiting for somebody to write.
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (descriptor < 0) return absl::ErrnoToStatus(errno, absl::StrCat(path, ": cannot open"));
  const absl::Cleanup close = [descriptor] { ::close(descriptor); };
  std::shared_ptr<SectionFile> file(new SectionFile(path));
  if (absl::Status status = file->read(descriptor, kind, access); !status.ok()) return status;
  return file;
}

absl::Status SectionFile::read(int descriptor, const FileKind& kind, FileAccess access) {
  struct stat status = {};
  if (::fstat(descriptor, &status) != 0) return absl::ErrnoToStatus(errno, absl::StrCat(path_, ": cannot read"));
  if (!S_ISREG(status.st_mode)) return absl::InvalidArgumentError(absl::StrCat(path_, ": not a file"));
  const auto size = static_cast<std::uint64_t>(status.st_size);
  device_ = status.st_dev;
  inode_ = status.st_ino;
  if (size < sizeof(Header)) return damaged(absl::StrCat("it has only ", size, " bytes"));
  if (size > kMaxFileSize) return damaged(absl::StrCat("it has ", size, " bytes, more than any such file"));
  if (access != FileAccess::kCopy && is_on_local_disk(descriptor)) {
    absl::StatusOr<MappedFile> mapping = MappedFile::map(descriptor, size);
    if (!mapping.ok()) return absl::Status(mapping.status().code(), absl::StrCat(path_, ": ", mapping.status().message()));
    mapping_ = *std::move(mapping);
    data_ = mapping_.bytes().data();
    size_ = size;
  } else if (absl::Status copied = copy(descriptor, size); !copied.ok()) {
    return copied;
  }
  if (absl::Status checked = check_header(kind); !checked.ok()) return checked;
  if (absl::Status checked = check_table(); !checked.ok()) return checked;
  if (access == FileAccess::kMapLazily) return absl::OkStatus();
  // Reading ahead is worth it only once the file is known for one of ours.
  if (is_mapped()) ::madvise(const_cast<std::byte*>(data_), size_, MADV_POPULATE_READ);
  return check_all();
}

absl::Status SectionFile::copy(int descriptor, std::uint64_t size) {
  auto* const data = static_cast<std::byte*>(::operator new (size, std::align_val_t{kAlignment}, std::nothrow));
  if (data == nullptr) return absl::ResourceExhaustedError(absl::StrCat(path_, ": no memory for ", size, " bytes"));
  data_ = data;
  while (size_ < size) {
    const ssize_t got = ::pread(descriptor, data + size_, size - size_, static_cast<off_t>(size_));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return absl::ErrnoToStatus(errno, absl::StrCat(path_, ": cannot read"));
    if (got == 0) return damaged("it became shorter while it was read");
    size_ += static_cast<std::uint64_t>(got);
  }
  return absl::OkStatus();
}

absl::Status SectionFile::status() const {
  if (!is_mapped()) return absl::OkStatus();
  // The end of a page that the file still has becomes zeros without a signal.
  struct stat now = {};
  const bool is_shorter = ::stat(path_.c_str(), &now) == 0 && now.st_dev == device_ && now.st_ino == inode_ &&
                          static_cast<std::uint64_t>(now.st_size) < size_;
  if (!is_shorter && !mapping_.is_lost()) return absl::OkStatus();
  return damaged("some of it is gone that was there when it was opened");
}

absl::Status SectionFile::damaged(const std::string& what) const {
  return absl::DataLossError(absl::StrCat(path_, ": damaged: ", what));
}

std::span<const SectionFile::Entry> SectionFile::table() const {
  const auto* header = reinterpret_cast<const Header*>(data_);
  return {reinterpret_cast<const Entry*>(data_ + sizeof(Header)), header->sections};
}

std::span<const std::uint64_t> SectionFile::sums() const {
  const std::span<const Entry> entries = table();
  return {reinterpret_cast<const std::uint64_t*>(entries.data() + entries.size()),
          reinterpret_cast<const Header*>(data_)->blocks};
}

absl::Status SectionFile::check_header(const FileKind& kind) {
  Header header;
  std::memcpy(&header, data_, sizeof header);
  if (std::memcmp(header.magic, kMagic, sizeof kMagic) != 0) return damaged("it is no file of this program");
  if (header.format_version != kFormatVersion) {
    return absl::FailedPreconditionError(
        absl::StrCat(path_, ": its format has version ", header.format_version, "; this program reads version ", kFormatVersion));
  }
  if (std::memcmp(header.kind, kind.name, sizeof kind.name) != 0 || header.kind_version != kind.version) {
    return absl::FailedPreconditionError(absl::StrCat(path_, ": it holds ", word(header.kind, sizeof header.kind), " version ",
                                                      header.kind_version, ", not ", word(kind.name, sizeof kind.name),
                                                      " version ", kind.version));
  }
  if (header.file_size != size_) return damaged(absl::StrCat("it has ", size_, " of ", header.file_size, " bytes"));
  static_assert(sizeof(Entry) == kAlignment);
  if (header.sections > kMaxSections || sizeof(Header) + header.sections * sizeof(Entry) > size_) {
    return damaged(absl::StrCat("it claims to have ", header.sections, " sections"));
  }
  const std::uint64_t room = size_ - sizeof(Header) - header.sections * sizeof(Entry);
  const std::uint64_t begin =
      header.blocks > room / sizeof(std::uint64_t)
          ? size_ + 1
          : aligned(sizeof(Header) + header.sections * sizeof(Entry) + header.blocks * sizeof(std::uint64_t));
  if (begin > size_ || (size_ - begin + kBlock - 1) / kBlock != header.blocks) {
    return damaged(absl::StrCat("it claims to have ", header.blocks, " blocks"));
  }
  if (header_hash({data_, begin}) != header.checksum) return damaged("its header has a wrong checksum");
  blocks_begin_ = begin;
  is_good_ = std::make_unique<std::atomic<bool>[]>(header.blocks);
  return absl::OkStatus();
}

absl::Status SectionFile::check_table() const {
  std::uint64_t end = blocks_begin_;
  std::set<std::string_view> names;
  for (const Entry& entry : table()) {
    const std::size_t length = strnlen(entry.name, sizeof entry.name);
    if (length == 0 || length > kMaxName || !names.insert({entry.name, length}).second) {
      return damaged("a section has no name, or another's");
    }
    const auto about = [&](const char* what) {
      return damaged(absl::StrCat("section ", word(entry.name, sizeof entry.name), " ", what));
    };
    if (entry.element_size < 1 || entry.element_size > kMaxElementSize) return about("has elements of an absurd size");
    if (entry.reserved != 0 || entry.reserved_too != 0) return about("has something else than zeros in reserve");
    if (entry.offset != aligned(end) || entry.offset > size_) return about("does not begin where the one before it ends");
    if (entry.count > (size_ - entry.offset) / entry.element_size) return about("reaches beyond the end of the file");
    end = entry.offset + entry.count * entry.element_size;
  }
  return end == size_ ? absl::OkStatus() : damaged("it goes on after its last section");
}

bool SectionFile::check_block(std::uint64_t i) const {
  if (is_good_[i].load(std::memory_order_acquire)) return true;
  const std::uint64_t at = blocks_begin_ + i * kBlock;
  if (hash({data_ + at, std::min(kBlock, size_ - at)}) != sums()[i]) return false;
  is_good_[i].store(true, std::memory_order_release);
  return true;
}

absl::Status SectionFile::wrong_block(std::uint64_t i) const {
  return damaged(absl::StrCat("bytes ", blocks_begin_ + i * kBlock, " and following have a wrong checksum"));
}

absl::Status SectionFile::check_all() const {
  const std::uint64_t blocks = sums().size();
  std::atomic<std::uint64_t> wrong = blocks;
  tbb::parallel_for(tbb::blocked_range<std::uint64_t>(0, blocks, kBlocksAtOnce), [&](const auto& range) {
    for (std::uint64_t i = range.begin(); i != range.end(); ++i) {
      if (!check_block(i)) wrong = i;
    }
  });
  return wrong == blocks ? absl::OkStatus() : wrong_block(wrong);
}

// On the calling thread: callers hold locks, for which threads that help would wait.
absl::Status SectionFile::check_bytes(std::span<const std::byte> bytes) const {
  const std::uint64_t begin = static_cast<std::uint64_t>(bytes.data() - data_) - blocks_begin_;
  for (std::uint64_t i = begin / kBlock; i <= (begin + bytes.size() - 1) / kBlock; ++i) {
    if (!check_block(i)) return wrong_block(i);
  }
  return absl::OkStatus();
}

absl::StatusOr<std::span<const std::byte>> SectionFile::find(std::string_view name, std::size_t element_size) const {
  for (const Entry& entry : table()) {
    if (name != std::string_view(entry.name, strnlen(entry.name, kMaxName))) continue;
    if (entry.element_size != element_size) {
      return damaged(absl::StrCat("section ", std::string(name), " has elements of ", entry.element_size, " bytes instead of ",
                                  element_size));
    }
    return std::span<const std::byte>(data_ + entry.offset, entry.count * entry.element_size);
  }
  return damaged("it has no section " + std::string(name));
}

}  // namespace curvecast
