// The module curvecast._native: surfaces in this process. curvecast/local.py is what users see of it.
#include <absl/strings/str_format.h>
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "client/python/native/arrays.h"
#include "client/python/native/interruptible.h"
#include "client/python/native/local_surface.h"
#include "core/mesh_io/mesh_companions.h"
#include "server/convert/convert_points.h"
#include "server/convert/scatter_request.h"

namespace curvecast::python {

namespace nb = nanobind;

namespace {

PyObject* error_type = nullptr;

template <typename Message>
Message parse(const nb::bytes& bytes) {
  Message message;
  if (!message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
    raise(absl::InternalError("the message could not be read: the module and the package differ in their version"));
  }
  return message;
}

nb::bytes to_bytes(const google::protobuf::MessageLite& message) {
  const std::string text = message.SerializeAsString();
  return nb::bytes(text.data(), text.size());
}

/// A file that Python holds in memory, and those that it refers to.
struct FileInMemory {
  FileInMemory(std::string file_name, const nb::bytes& file_bytes, const nb::dict& files)
      : name(std::move(file_name)), bytes(file_bytes) {
    for (const auto& [key, value] : files) companions.emplace(nb::cast<std::string>(key), nb::cast<nb::bytes>(value));
  }
  MeshFile view() const {
    const auto span_of = [](const nb::bytes& data) { return std::span<const char>(data.c_str(), data.size()); };
    std::map<std::string, std::span<const char>, std::less<>> spans;
    for (const auto& [key, value] : companions) spans.emplace(key, span_of(value));
    return {name, span_of(bytes), [spans = std::move(spans)](std::string_view wanted) -> std::optional<std::span<const char>> {
              const auto found = spans.find(wanted);
              return found == spans.end() ? std::nullopt : std::optional(found->second);
            }};
  }

  std::string name;
  nb::bytes bytes;
  std::map<std::string, nb::bytes, std::less<>> companions;
};

/// Moves the columns out that all points have.
nb::dict to_columns(PointSet& points) {
  nb::dict out;
  out["origin"] = array_of<double>(std::vector<double>(points.origin.data(), points.origin.data() + 3));
  if (!points.colours.empty()) {
    std::vector<std::uint8_t> colours(3 * points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Rgba8& colour = points.colours[i];
      colours[3 * i] = colour.r, colours[3 * i + 1] = colour.g, colours[3 * i + 2] = colour.b;
    }
    out["colours"] = array_of<std::uint8_t>(std::move(colours), 3);
  }
  out["positions"] = array_of<float>(std::move(points.positions), 3);
  out["normals"] = array_of<float>(std::move(points.normals), 3);
  out["radii"] = array_of<float>(std::move(points.radii));
  return out;
}

/// Moves all columns out.
nb::dict to_columns(server::Sampled& sampled, const server::PointAttributes& wanted) {
  PointSet& points = sampled.points();
  v1::PointAttributes more = server::to_proto(points, 0, points.size(), *sampled.curve, sampled.surface.get(), wanted);
  nb::dict out = to_columns(points);
  if (wanted.curvatures) out["curvatures"] = array_of<float>(std::move(*more.mutable_curvatures()), 2);
  if (wanted.rank) out["ranks"] = array_of<std::uint32_t>(std::move(points.ranks));
  if (wanted.surface) {
    out["faces"] = array_of<std::uint32_t>(std::move(*more.mutable_faces()));
    out["barycentric"] = array_of<float>(std::move(*more.mutable_barycentric()), 2);
  }
  if (wanted.directions) out["directions"] = array_of<float>(std::move(*more.mutable_directions()), 3);
  for (v1::ScalarValues& scalar : *more.mutable_scalars()) {
    out[nb::str(("scalar " + scalar.name()).c_str())] = array_of<float>(std::move(*scalar.mutable_values()));
  }
  out["statistics"] = to_bytes(server::to_proto(sampled.statistics));
  return out;
}

/// The frames of one viewer.
struct Stream {
  std::shared_ptr<LocalSurface> surface;
  std::shared_ptr<const server::ReferenceFrame> reference = nullptr;

  nb::bytes frame(const nb::bytes& request, bool key_frame, int threads) {
    const auto sample = parse<v1::SampleRequest>(request);
    std::shared_ptr<const server::ReferenceFrame> held = key_frame ? nullptr : reference;
    const v1::PointFrame made =
        run_or_raise(threads, nb::none(), [&](const ExecutionContext& context) { return surface->frame(sample, held, context); });
    reference = std::move(held);
    return to_bytes(made);
  }
};

std::vector<std::string> references(const std::string& name, const nb::bytes& bytes, const nb::dict& companions) {
  const FileInMemory file(name, bytes, companions);
  absl::StatusOr<std::vector<std::string>> names = mesh_companions(file.view());
  if (!names.ok()) raise(names.status());
  return *std::move(names);
}

/// Raises errors that name the mesh.
PolygonSoup soup_of(const Rows<double, 3>& vertices, const Rows<std::int64_t, 3>& faces, const nb::object& colours,
                    const nb::dict& scalars, const std::string& name) {
  absl::StatusOr<PolygonSoup> soup = to_soup(vertices, faces, colours, scalars);
  if (!soup.ok()) raise(absl::Status(soup.status().code(), absl::StrFormat("%s: %s", name, soup.status().message())));
  return *std::move(soup);
}

std::shared_ptr<LocalSurface> make_surface(const Rows<double, 3>& vertices, const Rows<std::int64_t, 3>& faces,
                                           const nb::object& colours, const nb::dict& scalars, const std::string& name,
                                           const nb::bytes& options, bool prepares, int threads, const nb::object& on_progress) {
  const auto session = parse<v1::SessionOptions>(options);
  PolygonSoup soup = soup_of(vertices, faces, colours, scalars, name);
  return run_or_raise(threads, on_progress, [&](const ExecutionContext& context) {
    return LocalSurface::make(std::move(soup), name, session, prepares, context);
  });
}

std::shared_ptr<LocalSurface> read_surface(const std::string& name, const nb::bytes& bytes, const nb::dict& companions,
                                           const nb::bytes& options, bool prepares, int threads, const nb::object& on_progress) {
  const auto session = parse<v1::SessionOptions>(options);
  const FileInMemory file(name, bytes, companions);
  const MeshFile view = file.view();
  return run_or_raise(threads, on_progress,
                      [&](const ExecutionContext& context) { return LocalSurface::read(view, session, prepares, context); });
}

nb::dict sample(LocalSurface& surface, const nb::bytes& request, int threads) {
  const auto message = parse<v1::SampleRequest>(request);
  server::PointAttributes wanted;
  server::Sampled sampled = run_or_raise(
      threads, nb::none(), [&](const ExecutionContext& context) { return surface.sample(message, wanted, context); });
  return to_columns(sampled, wanted);
}

std::vector<nb::bytes> remesh(LocalSurface& surface, const nb::bytes& request, int threads, const nb::object& on_progress) {
  const auto message = parse<v1::RemeshRequest>(request);
  const std::vector<v1::RemeshResponse> responses =
      run_or_raise(threads, on_progress, [&](const ExecutionContext& context) { return surface.remesh(message, context); });
  std::vector<nb::bytes> out;
  for (const v1::RemeshResponse& response : responses) out.push_back(to_bytes(response));
  return out;
}

/// Places on the file's faces.
void put_places(nb::dict& out, const std::vector<FacePlace>& places) {
  std::vector<std::uint32_t> faces(places.size());
  std::vector<float> weights(2 * places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    faces[i] = places[i].face;
    weights[2 * i] = places[i].weight_1, weights[2 * i + 1] = places[i].weight_2;
  }
  out["faces"] = array_of<std::uint32_t>(std::move(faces));
  out["barycentric"] = array_of<float>(std::move(weights), 2);
}

nb::dict features(LocalSurface& surface, double degrees, std::size_t points, std::uint64_t seed, int threads) {
  FeaturePoints found = run_or_raise(threads, nb::none(), [&](const ExecutionContext& context) -> absl::StatusOr<FeaturePoints> {
    FeaturePoints made = surface.features(degrees, points, seed, context);
    if (absl::Status status = context.check(); !status.ok()) return status;
    return made;
  });
  nb::dict out;
  out["length"] = found.length;
  for (FacePlace& place : found.places) place = place_in_file(place, surface.mesh().sources);
  put_places(out, found.places);
  out["positions"] = array_of<double>(std::move(found.positions), 3);
  out["normals"] = array_of<float>(std::move(found.normals), 6);
  return out;
}

nb::dict to_columns(ScatteredPoints scattered) {
  nb::dict out = to_columns(scattered.points);
  put_places(out, scattered.points.places);
  if (!scattered.points.ranks.empty()) out["ranks"] = array_of<std::uint32_t>(std::move(scattered.points.ranks));
  if (!scattered.curvatures.empty()) out["curvatures"] = array_of<float>(std::move(scattered.curvatures), 2);
  if (!scattered.directions.empty()) out["directions"] = array_of<float>(std::move(scattered.directions), 3);
  for (auto& [scalar, values] : scattered.scalars)
    out[nb::str(("scalar " + scalar).c_str())] = array_of<float>(std::move(values));
  return out;
}

/// `load`: gives the mesh. Columns by name.
template <typename Load>
nb::dict scatter_loaded(const nb::bytes& request, std::optional<double> crease_degrees, int threads,
                        const nb::object& on_progress, const Load& load) {
  const auto message = parse<v1::SampleRequest>(request);
  return to_columns(run_or_raise(threads, on_progress, [&](const ExecutionContext& context) -> absl::StatusOr<ScatteredPoints> {
    const absl::StatusOr<server::ScatterRequest> wanted = server::to_scatter_request(message, crease_degrees);
    if (!wanted.ok()) return wanted.status();
    const absl::StatusOr<LoadedMesh> loaded = load(context);
    if (!loaded.ok()) return loaded.status();
    return scatter_mesh(*loaded, wanted->scatter, context);
  }));
}

nb::dict scatter_on_surface(const LocalSurface& surface, const nb::bytes& request, int threads, const nb::object& on_progress) {
  const auto message = parse<v1::SampleRequest>(request);
  return to_columns(
      run_or_raise(threads, on_progress, [&](const ExecutionContext& context) { return surface.scatter(message, context); }));
}

nb::dict scatter(const Rows<double, 3>& vertices, const Rows<std::int64_t, 3>& faces, const nb::object& colours,
                 const nb::dict& scalars, const std::string& name, const nb::bytes& request, std::optional<double> crease_degrees,
                 int threads, const nb::object& on_progress) {
  PolygonSoup soup = soup_of(vertices, faces, colours, scalars, name);
  return scatter_loaded(request, crease_degrees, threads, on_progress,
                        [&](const ExecutionContext& context) { return load_mesh(std::move(soup), name, context); });
}

nb::dict scatter_file(const std::string& name, const nb::bytes& bytes, const nb::dict& companions, const nb::bytes& request,
                      std::optional<double> crease_degrees, int threads, const nb::object& on_progress) {
  const FileInMemory file(name, bytes, companions);
  const MeshFile view = file.view();
  return scatter_loaded(request, crease_degrees, threads, on_progress,
                        [&](const ExecutionContext& context) { return load_mesh(view, context); });
}

std::vector<Vec3d> to_places(const Rows<double, 3>& rows) {
  std::vector<Vec3d> out(rows.shape(0));
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = Vec3d(rows.data()[3 * i], rows.data()[3 * i + 1], rows.data()[3 * i + 2]);
  return out;
}

nb::object distances(LocalSurface& surface, const Rows<double, 3>& points, int threads) {
  const std::vector<Vec3d> places = to_places(points);
  return array_of<double>(
      run_or_raise(threads, nb::none(), [&](const ExecutionContext& context) { return surface.distances(places, context); }));
}

/// The repaired mesh.
nb::dict mesh(const LocalSurface& surface) {
  const LoadedMesh& loaded = surface.mesh();
  const std::size_t faces = loaded.mesh.face_count();
  std::vector<std::uint32_t> polygons(faces);
  std::vector<std::uint8_t> turned(faces);
  for (std::uint32_t f = 0; f < faces; ++f) {
    polygons[f] = loaded.sources.polygon(f);
    turned[f] = static_cast<std::uint8_t>(loaded.sources.is_turned(f));
  }
  nb::dict out;
  out["vertices"] = array_of<double>(loaded.mesh.positions, 3);
  out["triangles"] = array_of<std::uint32_t>(loaded.mesh.triangles, 3);
  out["faces"] = array_of<std::uint32_t>(std::move(polygons));
  out["turned"] = array_of<bool>(std::move(turned));
  return out;
}

nb::bytes measure(LocalSurface& surface, const nb::bytes& request, const std::vector<Rows<double, 3>>& sets, int threads,
                  const nb::object& on_progress) {
  const auto message = parse<v1::MeasureRequest>(request);
  std::vector<std::vector<Vec3d>> places;
  for (const Rows<double, 3>& set : sets) places.push_back(to_places(set));
  return to_bytes(run_or_raise(threads, on_progress,
                               [&](const ExecutionContext& context) { return surface.measure(message, places, context); }));
}

}  // namespace

void raise(const absl::Status& status) {
  const std::string message(status.message());
  const nb::object arguments = nb::make_tuple(static_cast<int>(status.code()), nb::str(message.data(), message.size()));
  PyErr_SetObject(error_type, arguments.ptr());
  throw nb::python_error();
}

}  // namespace curvecast::python

NB_MODULE(_native, m) {
  namespace nb = nanobind;
  using namespace nb::literals;
  using namespace curvecast::python;
  m.doc() = "Surfaces in this process. Messages are those of the API, as bytes; threads: 0 = one a core.";
  error_type =
      PyErr_NewExceptionWithDoc("curvecast._native.Error", "(code, message): code as gRPC numbers them.", nullptr, nullptr);
  m.attr("Error") = nb::borrow(error_type);
  m.def("references", &references, "name"_a, "data"_a, "companions"_a,
        "The files that a mesh file refers to and that are not among the companions yet.");
  m.def("scatter", &scatter, "vertices"_a, "faces"_a, "colours"_a.none(), "scalars"_a, "name"_a, "request"_a,
        "crease_degrees"_a.none(), "threads"_a, "on_progress"_a.none(), "Columns by name.");
  m.def("scatter_file", &scatter_file, "name"_a, "data"_a, "companions"_a, "request"_a, "crease_degrees"_a.none(), "threads"_a,
        "on_progress"_a.none(), "The same of a file.");
  nb::class_<LocalSurface>(m, "Surface")
      .def_static("make", &make_surface, "vertices"_a, "faces"_a, "colours"_a.none(), "scalars"_a, "name"_a, "options"_a,
                  "prepares"_a, "threads"_a, "on_progress"_a.none())
      .def_static("read", &read_surface, "name"_a, "data"_a, "companions"_a, "options"_a, "prepares"_a, "threads"_a,
                  "on_progress"_a.none())
      .def(
          "info", [](const LocalSurface& surface) { return to_bytes(surface.info()); }, "The MeshInfo.")
      .def("sample", &sample, "request"_a, "threads"_a, "Columns by name, and the statistics.")
      .def("scatter", &scatter_on_surface, "request"_a, "threads"_a, "on_progress"_a.none(), "Columns by name.")
      .def("remesh", &remesh, "request"_a, "threads"_a, "on_progress"_a.none(), "The answers to a RemeshRequest.")
      .def("features", &features, "degrees"_a, "points"_a, "seed"_a, "threads"_a,
           "Points on sharp edges: columns, and the length.")
      .def("distances", &distances, "points"_a, "threads"_a, "Signed distances.")
      .def("mesh", &mesh, "The repaired mesh: vertices, triangles, and the file's faces that these are.")
      .def("measure", &measure, "request"_a, "sets"_a, "threads"_a, "on_progress"_a.none(), "The Measures.");
  nb::class_<Stream>(m, "Stream")
      .def(
          "__init__", [](Stream* stream, std::shared_ptr<LocalSurface> surface) { new (stream) Stream{std::move(surface)}; },
          "surface"_a)
      .def("frame", &Stream::frame, "request"_a, "key_frame"_a, "threads"_a, "The PointFrame of a SampleRequest.");
}
