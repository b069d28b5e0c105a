// SPDX-License-Identifier: Apache-2.0
#include "proto/formats/points_json.h"

#include <charconv>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <type_traits>

namespace curvecast::formats {
namespace {

class Writer {
 public:
  explicit Writer(std::string& out) : out_(out) {}

  template <typename Value>
  void number(Value value) {
    if constexpr (std::is_floating_point_v<Value>) {
      if (!std::isfinite(value)) return put("null");
    }
    char digits[32];
    out_.append(digits, std::to_chars(std::begin(digits), std::end(digits), value).ptr);
  }

  template <typename Value, std::size_t N>
  void number(const std::array<Value, N>& values) {
    for (std::size_t i = 0; i < N; ++i) {
      if (i > 0) out_ += ',';
      number(values[i]);
    }
  }

  /// `name` as it stands in JSON.
  template <typename Values>
  void column(const std::string& name, const Values& values) {
    put(name + ":[");
    bool is_first = true;
    for (const auto& value : values) {
      if (!is_first) out_ += ',';
      is_first = false;
      number(value);
    }
    out_ += ']';
  }

  void put(std::string_view text) { out_ += text; }

 private:
  std::string& out_;
};

/// Names may hold anything.
std::string quoted(std::string_view name) {
  return nlohmann::json(std::string(name)).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace

absl::StatusOr<std::string> make_points_json(const PointColumns& columns) {
  if (absl::Status status = check_columns(columns); !status.ok()) return status;
  std::string out;
  Writer writer(out);
  writer.put("{\"count\":");
  writer.number(columns.size());
  writer.put(",");
  writer.column("\"origin\"", columns.origin);
  const auto add = [&](const char* name, const auto& values) {
    if (values.empty()) return;
    writer.put(",");
    writer.column(name, values);
  };
  add("\"positions\"", columns.positions);
  add("\"normals\"", columns.normals);
  add("\"radii\"", columns.radii);
  add("\"colours\"", columns.colours);
  add("\"curvatures\"", columns.curvatures);
  add("\"ranks\"", columns.ranks);
  add("\"faces\"", columns.faces);
  add("\"barycentric\"", columns.barycentric);
  add("\"directions\"", columns.directions);
  if (!columns.scalars.empty()) {
    writer.put(",\"scalars\":{");
    for (std::size_t s = 0; s < columns.scalars.size(); ++s) {
      if (s > 0) writer.put(",");
      writer.column(quoted(columns.scalars[s].name), columns.scalars[s].values);
    }
    writer.put("}");
  }
  writer.put("}\n");
  return out;
}

}  // namespace curvecast::formats
