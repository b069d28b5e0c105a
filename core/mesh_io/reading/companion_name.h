// Names that come out of a file and leave this machine: made safe as paths and as text.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace curvecast {

/// Tells whether the bytes are UTF-8 without control characters.
bool is_plain_text(std::string_view text);

/// Makes the name of a file that a mesh refers to safe, such that joined to the mesh's folder it stays in there: relative,
/// forward slashes, no `.`, no `..`, plain text, at most 255 bytes. Backslashes become slashes; of an absolute path, a drive, a
/// URL or a path with `..` only the last component is left. nullopt when nothing safe is left.
std::optional<std::string> safe_companion_name(std::string_view name);

/// Returns the safe name of a file that another companion refers to, relative to the folder of that one, `parent`, a safe name.
std::optional<std::string> safe_companion_name(std::string_view name, std::string_view parent);

/// Makes a name of something in the mesh (an attribute, a material) fit to be shown: as it is if it is plain text, else escaped;
/// at most 128 bytes or so.
std::string display_name(std::string_view name);

}  // namespace curvecast
