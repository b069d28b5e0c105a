// Elements of an XML text, as they come. The only door to Expat.
#pragma once

#include <absl/status/status.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

namespace curvecast {

struct XmlName {
  std::string_view space;  // the namespace, whole; of attributes without a prefix: empty
  std::string_view local;
};

/// The attributes of one element, while it is handled.
class XmlAttributes {
 public:
  explicit XmlAttributes(const char* const* pairs) : pairs_(pairs) {}
  std::optional<std::string_view> find(std::string_view local, std::string_view space = "") const;

 private:
  const char* const* pairs_;
};

/// Told of elements in the order of the text. A status that is not OK ends the parsing.
class XmlHandler {
 public:
  virtual ~XmlHandler() = default;
  /// A prefix stands for a namespace from now on; comes before the element that says so.
  virtual void prefix(std::string_view /*prefix*/, std::string_view /*space*/) {}
  virtual absl::Status start(const XmlName& name, const XmlAttributes& attributes) = 0;
  virtual absl::Status end() = 0;
};

/// Parses a text that comes in blocks, within 4 MiB of memory. InvalidArgument "line 3: ..." when it is malformed, has a document
/// type declaration (and so entities), elements 64 levels deep, or tags, names or comments that do not fit into that memory; and
/// what the handler says, the line put before it.
class XmlStream {
 public:
  /// Keeps a reference.
  explicit XmlStream(XmlHandler& handler);
  ~XmlStream();

  absl::Status take(std::span<const char> block);
  /// To be called after the last block.
  absl::Status finish();

 private:
  struct Parser;
  std::unique_ptr<Parser> parser_;
};

}  // namespace curvecast
