// Names that come out of a file and leave this machine: made safe as paths and as text.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace curvecast {

/// Whether the bytes are UTF-8 without control characters.
bool is_plain_text(std::string_view text);

/// The name of a file that a mesh refers to, such that joined to the mesh's folder it stays in there: relative, forward slashes,
/// no `.`, no `..`, plain text, at most 255 bytes. Backslashes become slashes; of an absolute path, a drive, a URL or a path with
/// `..` only the last component is left. nullopt when nothing safe is left.
std::optional<std::string> safe_companion_name(std::string_view name);

/// The same for a file named by another companion: relative to that one's folder. `parent` is a safe name.
std::optional<std::string> safe_companion_name(std::string_view name, std::string_view parent);

/// A name of something in the mesh (an attribute, a material): as it is if it is plain text, else escaped; at most 128 bytes or
/// so.
std::string display_name(std::string_view name);

}  // namespace curvecast
