// What one model part of a 3MF says, as plain structures: the core specification, and colour groups of the materials extension.
// Source: 3MF Consortium, 3D Manufacturing Format, core specification 1.3 and materials and properties extension 1.2.
#pragma once

#include <absl/status/status.h>

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/base/vec.h"
#include "core/mesh/mesh_attributes.h"
#include "core/mesh_io/three_mf/xml_stream.h"

namespace curvecast {

/// An object placed by another, or by the build.
struct ThreeMfInstance {
  std::uint32_t object = 0;                          // its id
  std::uint32_t part = 0;                            // index into ThreeMfModel::parts, in which the object is
  std::unique_ptr<const Eigen::Affine3d> transform;  // null: none
};

/// How a triangle looks.
struct ThreeMfLook {
  std::uint32_t material = MeshAttributes::kNoMaterial;
  Rgba8 colour;
};

struct ThreeMfObject {
  std::vector<Vec3d> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;  // of positions, all in range
  std::vector<ThreeMfLook> looks;                       // of triangles up to the last that has one
  std::vector<ThreeMfInstance> components;
};

struct ThreeMfModel {
  std::map<std::uint32_t, ThreeMfObject> objects;  // by id
  std::vector<ThreeMfInstance> build;
  std::vector<std::string> parts = {
      ""};  // names of model parts that are referred to, without the first slash; the first: this one
};

/// Takes a model part as it is parsed. Keeps references to all it is given. Base materials are appended to `materials`; what is
/// passed over, such as textures and beams, is warned of once.
class ThreeMfParser : public XmlHandler {
 public:
  ThreeMfParser(ThreeMfModel& model, std::vector<Material>& materials, std::vector<std::string>& warnings)
      : model_(model), materials_(materials), warnings_(warnings) {}

  void prefix(std::string_view prefix, std::string_view space) override;
  /// InvalidArgument for what is no model, for a required extension that is not read, for numbers that are none, vertices and
  /// objects that are not there before they are used, and too many objects.
  absl::Status start(const XmlName& name, const XmlAttributes& attributes) override;
  absl::Status end() override;

 private:
  /// What stands around what comes next.
  enum class Inside {
    kNothing,
    kModel,
    kResources,
    kBuild,
    kObject,
    kMesh,
    kVertices,
    kTriangles,
    kComponents,
    kMaterials,
    kColours,
    kPassed
  };

  /// Base materials, or colours, under one id.
  struct Group {
    std::size_t first = 0;  // material of the first, in `materials`
    std::size_t count = 0;  // of materials
    std::vector<Rgba8> colours;
  };

  absl::Status start_model(const XmlName& name, const XmlAttributes& attributes);
  absl::Status start_resource(const XmlName& name, const XmlAttributes& attributes, Inside& inside);
  absl::Status start_object(const XmlAttributes& attributes);
  absl::Status add_vertex(const XmlAttributes& attributes);
  absl::Status add_triangle(const XmlAttributes& attributes);
  absl::Status add_instance(const XmlAttributes& attributes, std::vector<ThreeMfInstance>& to);
  absl::Status add_colour(const XmlAttributes& attributes, const char* key, Rgba8& colour);
  /// Of a triangle; the object's own where it has none.
  absl::Status read_look(const XmlAttributes& attributes, ThreeMfLook& look);
  absl::Status look_of(std::uint32_t group, const std::array<std::uint32_t, 3>& properties, ThreeMfLook& look);
  void pass_over(const XmlName& name);

  ThreeMfModel& model_;
  std::vector<Material>& materials_;
  std::vector<std::string>& warnings_;
  std::vector<Inside> stack_;
  std::map<std::string, std::string, std::less<>> space_of_;  // by prefix
  std::map<std::string, std::uint32_t> part_of_;              // by name, index into the model's parts
  std::map<std::uint32_t, Group> groups_;
  Group* group_ = nullptr;           // at hand
  ThreeMfObject* object_ = nullptr;  // at hand
  std::uint32_t object_group_ = 0;   // properties of triangles that have none of their own; 0: none
  ThreeMfLook object_look_;
  std::vector<std::string> passed_;  // names of elements that have been warned of
};

}  // namespace curvecast
