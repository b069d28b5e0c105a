#include "tests/proto/formats/parsed_glb.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <utility>

#include "tests/proto/formats/sphere_columns.h"

namespace curvecast::formats {

ParsedGlb::ParsedGlb(std::string file, std::size_t points) : bytes_(std::move(file)), points_(points) {
  ByteReader reader(bytes_);
  EXPECT_EQ(reader.text(4), "glTF");
  EXPECT_EQ(reader.next<std::uint32_t>(), 2U);
  const auto length = reader.next<std::uint32_t>(), json_length = reader.next<std::uint32_t>();
  if (points == 0) {
    EXPECT_EQ(length, bytes_.size());
  }
  EXPECT_EQ(json_length % 4, 0U);
  EXPECT_EQ(reader.text(4), "JSON");
  json = nlohmann::json::parse(bytes_.substr(20, json_length));
  reader.skip(json_length);
  const auto binary_length = reader.next<std::uint32_t>();
  EXPECT_EQ(binary_length % 4, 0U);
  EXPECT_EQ(reader.text(4), "BIN");
  binary_ = reader.at();
  EXPECT_EQ(binary_ + binary_length, length);
}

const nlohmann::json& ParsedGlb::accessor(const std::string& semantic) const {
  return json["accessors"].at(json["meshes"][0]["primitives"][0]["attributes"].at(semantic).get<std::size_t>());
}

std::string ParsedGlb::view_bytes(std::size_t index) const {
  const nlohmann::json& view = json["bufferViews"].at(index);
  if (!view.contains("extensions")) {
    EXPECT_EQ(view["buffer"], 0);
    return bytes_.substr(binary_ + view.value("byteOffset", std::size_t{0}), view["byteLength"].get<std::size_t>());
  }
  const nlohmann::json& compressed = view["extensions"]["EXT_meshopt_compression"];
  EXPECT_EQ(compressed["buffer"], 0);
  EXPECT_EQ(view["buffer"], 1);
  EXPECT_EQ(compressed["mode"], "ATTRIBUTES");
  const std::size_t count = compressed["count"], stride = compressed["byteStride"], offset = compressed["byteOffset"];
  EXPECT_EQ(view["byteLength"], count * stride);
  std::string out(count * stride, '\0');
  EXPECT_EQ(meshopt_decodeVertexBuffer(out.data(), count, stride,
                                       reinterpret_cast<const unsigned char*>(bytes_.data()) + binary_ + offset,
                                       compressed["byteLength"].get<std::size_t>()),
            0);
  const std::string filter = compressed.value("filter", "NONE");
  if (filter == "OCTAHEDRAL") meshopt_decodeFilterOct(out.data(), count, stride);
  if (filter == "EXPONENTIAL") meshopt_decodeFilterExp(out.data(), count, stride);
  return out;
}

std::vector<std::vector<double>> ParsedGlb::numbers(const std::string& semantic) const {
  const nlohmann::json& of = accessor(semantic);
  const std::size_t view = of["bufferView"];
  const std::string bytes = view_bytes(view);
  const std::size_t stride = json["bufferViews"][view]["byteStride"], offset = of.value("byteOffset", std::size_t{0});
  const bool normalised = of.value("normalized", false);
  const std::string type = of["type"];
  const int width = type == "SCALAR" ? 1 : type.back() - '0';
  std::vector<std::vector<double>> points;
  const std::size_t count = points_ > 0 ? points_ : of["count"].get<std::size_t>();
  for (std::size_t i = 0; i < count; ++i) {
    ByteReader reader(bytes);
    reader.skip(i * stride + offset);
    std::vector<double>& numbers = points.emplace_back();
    for (int k = 0; k < width; ++k) {
      switch (of["componentType"].get<int>()) {
        case 5120:
          numbers.push_back(reader.next<std::int8_t>() / (normalised ? 127.0 : 1.0));
          break;
        case 5123:
          numbers.push_back(reader.next<std::uint16_t>() / (normalised ? 65535.0 : 1.0));
          break;
        case 5126:
          numbers.push_back(reader.next<float>());
          break;
        default:
          ADD_FAILURE() << of;
      }
    }
  }
  return points;
}

std::array<double, 3> ParsedGlb::in_scene(const std::vector<double>& position) const {
  const nlohmann::json& node = json["nodes"][json["scenes"][json["scene"].get<std::size_t>()]["nodes"][0].get<std::size_t>()];
  const auto scale = node.value("scale", std::array<double, 3>{1, 1, 1}),
             translation = node.value("translation", std::array<double, 3>{});
  std::array<double, 3> place;
  for (std::size_t axis = 0; axis < 3; ++axis) place[axis] = scale[axis] * position[axis] + translation[axis];
  return place;
}

}  // namespace curvecast::formats
