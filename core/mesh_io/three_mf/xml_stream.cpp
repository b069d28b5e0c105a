#include "core/mesh_io/three_mf/xml_stream.h"

#include <absl/strings/str_format.h>
#include <expat.h>

#include <cstdlib>
#include <cstring>
#include <new>
#include <string>
#include <utility>

namespace curvecast {
namespace {

constexpr char kSeparator = '|';  // between namespace and name
constexpr int kMostLevels = 64;
constexpr std::size_t kMostMemory = 4 << 20;

/// Expat keeps every name and prefix that it has seen, and a tag until it is whole. Its memory is bounded by counting.
struct Memory {
  std::size_t used = 0;
};
thread_local Memory* memory_at_hand = nullptr;

class Counting {
 public:
  explicit Counting(Memory& memory) : before_(std::exchange(memory_at_hand, &memory)) {}
  ~Counting() { memory_at_hand = before_; }
  Counting(const Counting&) = delete;
  Counting& operator=(const Counting&) = delete;

 private:
  Memory* const before_;
};

constexpr std::size_t kHead = alignof(std::max_align_t);  // before each piece: its size

void* change_size(void* piece, std::size_t size) {
  char* const begin = piece != nullptr ? static_cast<char*>(piece) - kHead : nullptr;
  std::size_t before = 0;
  if (begin != nullptr) std::memcpy(&before, begin, sizeof(before));
  Memory& memory = *memory_at_hand;
  if (size > kMostMemory || memory.used - before + size + kHead > kMostMemory) return nullptr;
  char* const changed = static_cast<char*>(std::realloc(begin, size + kHead));
  if (changed == nullptr) return nullptr;
  const std::size_t whole = size + kHead;
  memory.used += whole - before;
  std::memcpy(changed, &whole, sizeof(whole));
  return changed + kHead;
}

void* take_piece(std::size_t size) { return change_size(nullptr, size); }

void give_piece_back(void* piece) {
  if (piece == nullptr) return;
  char* const begin = static_cast<char*>(piece) - kHead;
  std::size_t whole = 0;
  std::memcpy(&whole, begin, sizeof(whole));
  memory_at_hand->used -= whole;
  std::free(begin);
}

XmlName split(const char* written) {
  const std::string_view name(written);
  const std::size_t at = name.rfind(kSeparator);
  if (at == std::string_view::npos) return {.space = {}, .local = name};
  return {.space = name.substr(0, at), .local = name.substr(at + 1)};
}

}  // namespace

std::optional<std::string_view> XmlAttributes::find(std::string_view local, std::string_view space) const {
  for (const char* const* pair = pairs_; pair[0] != nullptr; pair += 2) {
    const XmlName name = split(pair[0]);
    if (name.local == local && name.space == space) return std::string_view(pair[1]);
  }
  return std::nullopt;
}

struct XmlStream::Parser {
  explicit Parser(XmlHandler& to) : handler(to) {
    const Counting counting(memory);
    const XML_Memory_Handling_Suite suite = {take_piece, change_size, give_piece_back};
    const char separator[] = {kSeparator, '\0'};
    expat = XML_ParserCreate_MM(nullptr, &suite, separator);
    if (expat == nullptr) throw std::bad_alloc();
    XML_SetUserData(expat, this);
    XML_SetElementHandler(expat, start, end);
    XML_SetStartNamespaceDeclHandler(expat, prefix);
    XML_SetStartDoctypeDeclHandler(expat, doctype);
  }
  ~Parser() {
    const Counting counting(memory);
    XML_ParserFree(expat);
  }
  Parser(const Parser&) = delete;
  Parser& operator=(const Parser&) = delete;

  static Parser& of(void* data) { return *static_cast<Parser*>(data); }
  static void start(void* data, const char* name, const char** pairs) {
    Parser& self = of(data);
    self.run([&] {
      if (self.level++ == kMostLevels) {
        return absl::InvalidArgumentError(absl::StrFormat("elements are nested deeper than %d levels", kMostLevels));
      }
      return self.handler.start(split(name), XmlAttributes(pairs));
    });
  }
  static void end(void* data, const char*) {
    Parser& self = of(data);
    --self.level;
    self.run([&] { return self.handler.end(); });
  }
  static void prefix(void* data, const char* written, const char* space) {
    Parser& self = of(data);
    self.run([&] {
      self.handler.prefix(written != nullptr ? written : "", space != nullptr ? space : "");
      return absl::OkStatus();
    });
  }
  static void doctype(void* data, const char*, const char*, const char*, int) {
    of(data).run([] { return absl::InvalidArgumentError("there is a document type declaration, which is not read"); });
  }

  /// No exception may pass through Expat, which is C.
  template <class Work>
  void run(const Work& work) {
    if (!status.ok() || out_of_memory) return;
    try {
      status = work();
    } catch (const std::bad_alloc&) {
      out_of_memory = true;
    }
    if (!status.ok() || out_of_memory) XML_StopParser(expat, XML_FALSE);
  }

  absl::Status parse(std::span<const char> block, bool is_last) {
    const Counting counting(memory);
    if (XML_Parse(expat, block.data(), static_cast<int>(block.size()), is_last ? 1 : 0) != XML_STATUS_ERROR)
      return absl::OkStatus();
    if (out_of_memory) throw std::bad_alloc();
    std::string what(status.message());
    if (status.ok()) {
      const XML_Error error = XML_GetErrorCode(expat);
      what = error == XML_ERROR_NO_MEMORY ? "a tag is too long, or there are too many different names"
                                          : absl::StrFormat("the XML is malformed (%s)", XML_ErrorString(error));
    }
    return absl::Status(status.ok() ? absl::StatusCode::kInvalidArgument : status.code(),
                        absl::StrFormat("line %d: %s", XML_GetCurrentLineNumber(expat), what));
  }

  XmlHandler& handler;
  Memory memory;
  XML_Parser expat = nullptr;
  int level = 0;
  absl::Status status;
  bool out_of_memory = false;
};

XmlStream::XmlStream(XmlHandler& handler) : parser_(std::make_unique<Parser>(handler)) {}
XmlStream::~XmlStream() = default;

absl::Status XmlStream::take(std::span<const char> block) { return parser_->parse(block, false); }
absl::Status XmlStream::finish() { return parser_->parse({}, true); }

}  // namespace curvecast
