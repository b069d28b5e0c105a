#include "core/mesh_io/mtl_reader.h"

#include <algorithm>
#include <utility>

#include "core/base/text_scanner.h"
#include "core/mesh_io/reading/mesh_reading.h"

namespace curvecast {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

std::string_view rest_of_line(const TextScanner& scanner) { return trimmed(TextScanner(scanner).line_rest()); }

// Behind map_Kd: options, each a word that begins with '-' and its values, and then the name, which may hold blanks.
std::string_view texture_name(std::string_view text) {
  constexpr std::pair<std::string_view, int> kOptions[] = {{"-blendu", 1}, {"-blendv", 1}, {"-cc", 1},   {"-clamp", 1},
                                                           {"-mm", 2},     {"-texres", 1}, {"-type", 1}, {"-imfchan", 1},
                                                           {"-bm", 1},     {"-boost", 1}};
  TextScanner scanner(text);
  while (scanner.peek() == '-') {
    const std::string_view option = scanner.peek_word();
    const auto known = std::find_if(std::begin(kOptions), std::end(kOptions), [&](const auto& o) { return o.first == option; });
    const bool vector = option == "-o" || option == "-s" || option == "-t";  // one to three numbers
    if (known == std::end(kOptions) && !vector) break;
    scanner.skip_word();
    scanner.skip_blanks();
    if (vector) {
      double value = 0;
      for (int i = 0; i < 3 && scanner.number(value); ++i) scanner.skip_blanks();
    } else {
      for (int i = 0; i < known->second; ++i) {
        scanner.skip_word();
        scanner.skip_blanks();
      }
    }
  }
  return rest_of_line(scanner);
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::vector<std::string_view> library_names(std::string_view line) {
  std::vector<std::string_view> names;
  line = trimmed(line);
  std::size_t end = 0;
  for (TextScanner scanner(line); !scanner.at_end(); scanner.skip_blanks()) {
    const std::string_view word = scanner.word();
    end = static_cast<std::size_t>(word.data() + word.size() - line.data());
    if (word.size() < 4 || !equals_ignoring_case(word.substr(word.size() - 4), ".mtl")) continue;
    names.push_back(trimmed(line.substr(0, end)));
    line.remove_prefix(end);
  }
  if (line = trimmed(line); !line.empty()) names.push_back(line);
  return names;
}

std::vector<MtlMaterial> read_mtl(std::string_view text) {
  std::vector<MtlMaterial> materials;
  for (TextScanner scanner(text); !scanner.at_end(); scanner.next_line()) {
    scanner.skip_blanks();
    const std::string_view keyword = scanner.word();
    scanner.skip_blanks();
    if (keyword == "newmtl") {
      materials.emplace_back().name = rest_of_line(scanner);
      continue;
    }
    if (materials.empty()) continue;
    MtlMaterial& material = materials.back();
    if (keyword == "Kd") {
      double rgb[3];
      int read = 0;
      for (; read < 3 && scanner.number(rgb[read]); ++read) scanner.skip_blanks();
      if (read == 1) rgb[1] = rgb[2] = rgb[0];  // a single value stands for all three
      if (read == 0 || read == 2) continue;     // "spectral" and the like
      material.colour.r = unit_to_byte(rgb[0]);
      material.colour.g = unit_to_byte(rgb[1]);
      material.colour.b = unit_to_byte(rgb[2]);
    } else if (keyword == "d" || keyword == "Tr") {
      double value = 0;
      if (scanner.number(value)) material.colour.a = unit_to_byte(keyword == "d" ? value : 1 - value);
    } else if (keyword == "map_Kd") {
      material.texture = texture_name(rest_of_line(scanner));
      material.line = scanner.line();
    }
  }
  return materials;
}

}  // namespace curvecast
