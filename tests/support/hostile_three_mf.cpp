#include <cstdint>
#include <functional>

#include "tests/core/mesh_io/three_mf_writer.h"
#include "tests/support/hostile_files.h"

namespace curvecast::testing {
namespace {

const std::string kItem = "<item objectid=\"1\"/>\n";

std::string object() { return three_mf_object(1, tetrahedron()); }

std::string repeated(const std::string& text, int times) {
  std::string out;
  out.reserve(text.size() * static_cast<std::size_t>(times));
  for (int i = 0; i < times; ++i) out += text;
  return out;
}

struct Builder {
  std::vector<HostileFile> files;

  void archive(const std::string& what, const std::string& bytes, const std::string& words) {
    files.push_back({.what = "3MF " + what, .name = "a.3mf", .bytes = bytes, .words = {words}});
  }
  void model(const std::string& what, const std::string& text, const std::string& words) {
    archive(what, three_mf_file(text), words);
  }
  void use(const std::vector<std::string>& words = {}) {
    files.back().usable = true;
    files.back().words = words;
  }
  /// The last one may take more memory than usual, in proportion to what it unpacks to.
  void allow(std::size_t mebibytes) { files.back().memory = mebibytes << 20; }
};

/// `at` counts from the end of the archive for negative numbers.
std::string patched(std::string bytes, std::ptrdiff_t at, std::uint32_t word) {
  std::string four;
  append(four, word);
  return bytes.replace(static_cast<std::size_t>(at < 0 ? static_cast<std::ptrdiff_t>(bytes.size()) + at : at), 4, four);
}

void add_archives(Builder& b) {
  const std::string whole = three_mf_tetrahedron();
  for (const std::size_t part : {1, 4, 8, 15}) {
    b.archive("cut to " + std::to_string(part) + " sixteenths", whole.substr(0, whole.size() * part / 16),
              "the ZIP archive is broken: it has no directory at its end; is it cut short?");
  }
  b.archive("of only its magic", "PK\3\4", "it has no directory at its end");
  b.archive("with a directory of 2^32 - 2 bytes", patched(whole, -10, UINT32_MAX - 1),
            "the directory of the ZIP archive takes 4294967294 bytes, more than 1048576");
  b.archive("with a directory that is elsewhere", patched(whole, -6, 7), "the ZIP archive is broken");
  b.archive("without relations", zip_of({{"3D/3dmodel.model", three_mf_model(object(), kItem)}}),
            "this is a ZIP archive, but no 3MF: it has no '_rels/.rels'");
  b.archive("whose relations name nothing", zip_of({{"_rels/.rels", "<a/>"}}),
            "this is a ZIP archive, but no 3MF: '_rels/.rels' names no model");
  b.archive("whose relations are no XML", zip_of({{"_rels/.rels", "nothing"}}), "_rels/.rels: line 1: the XML is malformed");
  b.archive("whose model is not there", zip_of({{"_rels/.rels", kThreeMfRelations}}),
            "the model '3D/3dmodel.model' is not in the archive");
  const std::size_t name = whole.rfind("3D/3dmodel.model");
  // Of its entry in the directory: 46 bytes stand before the name, the sum of bytes from 16 on, then the sizes.
  b.archive("whose bytes have another sum", patched(whole, static_cast<std::ptrdiff_t>(name) - 30, 7),
            "the ZIP archive is broken");
  b.archive("that claims 2^31 bytes", patched(whole, static_cast<std::ptrdiff_t>(name) - 22, 1U << 31),
            "the model '3D/3dmodel.model' is not in the archive, or is packed in a way that is not read");
  b.archive("that claims a byte more than there is",
            patched(whole, static_cast<std::ptrdiff_t>(name) - 22,
                    static_cast<std::uint32_t>(three_mf_model(object(), kItem).size() + 1)),
            "3D/3dmodel.model: the ZIP archive is broken");
  b.archive("that claims 10 bytes", patched(whole, static_cast<std::ptrdiff_t>(name) - 22, 10),
            "3D/3dmodel.model: the ZIP archive is broken");
  b.model("of two million blanks", three_mf_model(object(), kItem) + std::string(2'000'000, ' '),
          "the model '3D/3dmodel.model' is not in the archive, or is packed in a way that is not read");
}

void add_xml(Builder& b) {
  const std::string entities =
      "<!DOCTYPE m [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;\"><!ENTITY c "
      "\"&b;&b;&b;&b;&b;&b;&b;&b;&b;&b;\"><!ENTITY d \"&c;&c;&c;&c;&c;&c;&c;&c;&c;&c;\">]><m>&d;</m>";
  b.model("of growing entities", entities, "3D/3dmodel.model: line 1: there is a document type declaration");
  b.model("of an entity that is not there", "<model>&a;</model>", "3D/3dmodel.model: line 1: ");
  b.model("of no XML", "vertex 1 2 3", "3D/3dmodel.model: line 1: the XML is malformed");
  b.model("of an empty text", "", "3D/3dmodel.model: line 1: the XML is malformed (no element found)");
  b.model("of text that ends", three_mf_model(object(), kItem).substr(0, 600), "line 14: the XML is malformed (unclosed token)");
  b.model("of another element", "<a/>", "line 1: this is no 3MF model: it begins with 'a'");
  b.model("of 100 levels", three_mf_model(repeated("<a>", 100) + repeated("</a>", 100), ""),
          "line 4: elements are nested deeper than 64 levels");
  b.model("of 100,000 levels", three_mf_model(repeated("<a>", 100'000), ""), "elements are nested deeper than 64 levels");
  b.model("of bytes that are not UTF-8", three_mf_model("<a b=\"\xff\xfe\"/>", ""), "the XML is malformed");
  std::string digits;  // that deflate does not shrink much
  for (std::uint32_t i = 0, state = 1; i < 1'200'000; ++i) {
    state = 1'664'525 * state + 1'013'904'223;
    digits += static_cast<char>('a' + (state >> 24) % 26);
  }
  b.model("with an attribute of a megabyte", three_mf_model("<a b=\"" + digits + "\"/>" + object(), kItem), "");
  b.use({"The elements 'a' of the 3MF are left out."});
  std::string longer = digits;
  for (int i = 0; i < 4; ++i) longer += digits;
  b.model("with an attribute of six megabytes", three_mf_model("<a b=\"" + longer + "\"/>" + object(), kItem),
          "a tag is too long, or there are too many different names");
  std::string names;
  for (int i = 0; i < 100'000; ++i) names += "<a" + std::to_string(i) + "/>";
  b.model("with 100,000 different elements", three_mf_model(names + object(), kItem),
          "a tag is too long, or there are too many different names");
  std::string prefixes;
  for (int i = 0; i < 60'000; ++i) prefixes += "<a xmlns:p" + std::to_string(i) + "=\"u\"/>";
  b.model("with 60,000 different prefixes", three_mf_model(prefixes + object(), kItem),
          "a tag is too long, or there are too many different names");
}

void add_models(Builder& b) {
  const auto components = [](int id, const std::string& list) {
    return "<object id=\"" + std::to_string(id) + "\"><components>" + list + "</components></object>\n";
  };
  b.model("without a build", three_mf_model(object(), ""), "no faces");
  b.model("of an unknown extension", three_mf_model(object(), kItem, "xmlns:q=\"http://q\" requiredextensions=\"m q\""),
          "3D/3dmodel.model: line 2: the file requires the extension http://q, which is not supported; export it without");
  b.model("of an extension without a namespace", three_mf_model(object(), kItem, "requiredextensions=\"zz\""),
          "the file requires the extension zz");
  b.model("of an object that is not there", three_mf_model(object(), "<item objectid=\"9\"/>"),
          "3D/3dmodel.model: there is no object 9");
  b.model("of an item without an object", three_mf_model(object(), "<item/>"), "there is no objectid");
  b.model("of object 2^32", three_mf_model(object(), "<item objectid=\"4294967296\"/>"),
          "objectid is '4294967296', which is none");
  b.model("of two objects 1", three_mf_model(object() + object(), kItem), "there are two objects 1");
  b.model("of an object that is a part of itself", three_mf_model(components(1, "<component objectid=\"1\"/>"), kItem),
          "object 1: components are nested deeper than 32 levels; is one a part of itself?");
  std::string doubling = object();
  for (int i = 2; i < 32; ++i) doubling += components(i, repeated("<component objectid=\"" + std::to_string(i - 1) + "\"/>", 2));
  b.model("of doubling components, 30 levels deep", three_mf_model(doubling, "<item objectid=\"31\"/>"),
          "the build repeats its objects until it has more than");
  b.model("of 20,000 items", three_mf_model(object(), repeated(kItem, 20'000)), "");
  b.use();
  b.allow(32);
  b.model("of a transform of eleven numbers",
          three_mf_model(object(), "<item objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 0 0\"/>"),
          "transform is '1 0 0 0 1 0 0 0 1 0 0', which is none");
  b.model("of a transform of thirteen numbers",
          three_mf_model(object(), "<item objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 0 0 0 0\"/>"), "which is none");
  b.model("of a transform of NaNs", three_mf_model(object(), "<item objectid=\"1\" transform=\"nan 0 0 0 1 0 0 0 1 0 0 0\"/>"),
          "object 1, vertex 0: a coordinate is not a finite number");
  b.model("of a transform beyond a double",
          three_mf_model(object(), "<item objectid=\"1\" transform=\"1e999 0 0 0 1 0 0 0 1 0 0 0\"/>"),
          "object 1, vertex 0: a coordinate is not a finite number");
  b.model("of a transform to nothing", three_mf_model(object(), "<item objectid=\"1\" transform=\"0 0 0 0 0 0 0 0 0 0 0 0\"/>"),
          "the mesh has no face with an area");
  b.model("of a colour that is none",
          three_mf_model("<basematerials id=\"2\"><base displaycolor=\"red\"/></basematerials>" + object(), kItem),
          "line 4: displaycolor is 'red', which is none");
  b.model("of a material without a colour",
          three_mf_model("<basematerials id=\"2\"><base name=\"a\"/></basematerials>" + object(), kItem),
          "line 4: there is no displaycolor");
  b.model("of a property that is not there",
          three_mf_model("<basematerials id=\"2\"><base displaycolor=\"#112233\"/></basematerials>" +
                             three_mf_object(1, tetrahedron(), "", " pid=\"2\" p1=\"1\""),
                         kItem),
          "group 2 has no property 1 (it has 1)");
  b.model("of a property group that is not there",
          three_mf_model(three_mf_object(1, tetrahedron(), "", " pid=\"7\" p1=\"1\""), kItem), "");
  b.use();
  b.model("of an object of nothing", three_mf_model("<object id=\"1\"/>", kItem), "no faces");
  b.model("of a group without a number", three_mf_model("<basematerials/>", kItem), "there is no id");
  std::string objects;
  for (int i = 2; i < 100'002; ++i) objects += "<object id=\"" + std::to_string(i) + "\"/>";
  b.model("of 100,000 empty objects", three_mf_model(objects + object(), kItem), "there are more than 100000 objects and groups");
  b.allow(48);
  std::string parts;
  for (int i = 0; i < 5'000; ++i) parts += "<item objectid=\"1\" p:path=\"/" + std::to_string(i) + ".model\"/>";
  b.model("of 5,000 other parts", three_mf_model(object(), parts), "it refers to more than 4096 other parts");
  b.model("of a part that is no model", three_mf_model(object(), "<item objectid=\"1\" p:path=\"/_rels/.rels\"/>"),
          "the part '_rels/.rels' is no model by its name");
  std::string vertices;
  for (int i = 0; i < 60'000; ++i)
    vertices += "<vertex x=\"" + std::to_string(i % 10) + "\" y=\"" + std::to_string(i / 7 % 10) + "\" z=\"1\"/>";
  b.model("of 60,000 vertices and no triangles",
          three_mf_model("<object id=\"1\"><mesh><vertices>" + vertices + "</vertices></mesh></object>", kItem), "no faces");
}

}  // namespace

std::vector<HostileFile> hostile_three_mf_files() {
  Builder builder;
  add_archives(builder);
  add_xml(builder);
  add_models(builder);
  return std::move(builder.files);
}

}  // namespace curvecast::testing
