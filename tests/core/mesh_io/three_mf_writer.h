// 3MF files made in memory, for the tests of the reader.
#pragma once

#include <zip.h>

#include <map>
#include <string>

#include "tests/core/mesh_io/mesh_writers.h"

namespace curvecast {

/// A ZIP archive of some files by their names, packed unless they are `stored`.
inline std::string zip_of(const std::map<std::string, std::string>& files, bool stored = false) {
  zip_error_t error;
  zip_source_t* const to = zip_source_buffer_create(nullptr, 0, 0, &error);
  zip_source_keep(to);
  zip_t* const archive = zip_open_from_source(to, ZIP_TRUNCATE, &error);
  for (const auto& [name, bytes] : files) {
    const zip_int64_t index = zip_file_add(archive, name.c_str(), zip_source_buffer(archive, bytes.data(), bytes.size(), 0), 0);
    zip_set_file_compression(archive, static_cast<zip_uint64_t>(index), stored ? ZIP_CM_STORE : ZIP_CM_DEFLATE, 9);
    zip_file_set_mtime(archive, static_cast<zip_uint64_t>(index), 1'000'000'000, 0);
  }
  zip_close(archive);
  zip_stat_t stat;
  zip_source_open(to);
  zip_source_stat(to, &stat);
  std::string out(stat.size, '\0');
  zip_source_read(to, out.data(), out.size());
  zip_source_close(to);
  zip_source_free(to);
  return out;
}

inline constexpr char kThreeMfRelations[] =
    "<?xml version=\"1.0\"?>\n<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">"
    "<Relationship Id=\"r\" Target=\"/3D/3dmodel.model\" "
    "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>";

/// A model's text: what stands in `resources` and in `build`.
inline std::string three_mf_model(const std::string& resources, const std::string& build,
                                  const std::string& attributes = "unit=\"millimeter\"") {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model " + attributes +
         " xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\""
         " xmlns:m=\"http://schemas.microsoft.com/3dmanufacturing/material/2015/02\""
         " xmlns:p=\"http://schemas.microsoft.com/3dmanufacturing/production/2015/06\">\n<resources>\n" +
         resources + "</resources>\n<build>\n" + build + "</build>\n</model>\n";
}

/// The text of an object's mesh. `extra`: attributes of every triangle.
inline std::string three_mf_mesh(const FileMesh& mesh, const std::string& extra = "") {
  std::ostringstream out;
  out << "<mesh><vertices>\n";
  for (const auto& [x, y, z] : mesh.vertices) out << "<vertex x=\"" << x << "\" y=\"" << y << "\" z=\"" << z << "\"/>\n";
  out << "</vertices><triangles>\n";
  for (const auto& face : mesh.faces) {
    out << "<triangle v1=\"" << face[0] << "\" v2=\"" << face[1] << "\" v3=\"" << face[2] << "\"" << extra << "/>\n";
  }
  out << "</triangles></mesh>";
  return out.str();
}

/// An object of that mesh.
inline std::string three_mf_object(int id, const FileMesh& mesh, const std::string& attributes = "",
                                   const std::string& extra = "") {
  return "<object id=\"" + std::to_string(id) + "\" " + attributes + ">" + three_mf_mesh(mesh, extra) + "</object>\n";
}

/// A file of one model part, and others.
inline std::string three_mf_file(const std::string& model, const std::map<std::string, std::string>& others = {},
                                 bool stored = false) {
  std::map<std::string, std::string> files = {{"_rels/.rels", kThreeMfRelations}, {"3D/3dmodel.model", model}};
  files.insert(others.begin(), others.end());
  return zip_of(files, stored);
}

/// The tetrahedron, placed once.
inline std::string three_mf_tetrahedron() {
  return three_mf_file(three_mf_model(three_mf_object(1, tetrahedron()), "<item objectid=\"1\"/>\n"));
}

}  // namespace curvecast
