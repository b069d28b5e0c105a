// SPDX-License-Identifier: Apache-2.0
// Draco for Python: one function, from the bytes of a block to the bytes of its columns.
#define PY_SSIZE_T_CLEAN
#define Py_LIMITED_API 0x030a0000  // one module for all versions from 3.10 on
#include <Python.h>
#include <absl/status/statusor.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "client/lib/draco/draco_points.h"
#include "client/lib/protocol.h"

namespace {

using curvecast::client::DecodedPoints;

/// Counts are refused before anything is decoded: a few bytes can claim to be gigabytes.
absl::StatusOr<DecodedPoints> decode_points(std::string_view bytes, const curvecast::client::RadiusRange& radii,
                                            std::uint64_t count) {
  if (!radii.valid()) return absl::InvalidArgumentError("the range of its radii makes no sense");
  const auto header = curvecast::client::check_draco_header(bytes, curvecast::client::kMaxPoints);
  if (!header.ok()) return header.status();
  if (header->points != count) {
    return absl::InvalidArgumentError("its Draco data claims " + std::to_string(header->points) + " points, the block " +
                                      std::to_string(count));
  }
  absl::StatusOr<DecodedPoints> points = curvecast::client::decode_draco(bytes, *header, radii);
  if (points.ok() && (points->normals.empty() || points->radii.empty())) {
    return absl::InvalidArgumentError("its Draco data lacks normals or radii");
  }
  return points;
}

template <typename T>
PyObject* to_bytes(const std::vector<T>& values) {
  return PyBytes_FromStringAndSize(reinterpret_cast<const char*>(values.data()),
                                   static_cast<Py_ssize_t>(sizeof(T) * values.size()));
}

PyObject* decode(PyObject*, PyObject* arguments) {
  const char* data = nullptr;
  Py_ssize_t size = 0;
  curvecast::client::RadiusRange radii;
  unsigned long long count = 0;
  if (!PyArg_ParseTuple(arguments, "y#ffK:decode", &data, &size, &radii.min, &radii.max, &count)) return nullptr;
  absl::StatusOr<DecodedPoints> points;
  Py_BEGIN_ALLOW_THREADS;
  points = decode_points({data, static_cast<std::size_t>(size)}, radii, count);
  Py_END_ALLOW_THREADS;
  if (!points.ok()) {
    PyErr_SetString(PyExc_ValueError, std::string(points.status().message()).c_str());
    return nullptr;
  }
  return Py_BuildValue("(NNNN)", to_bytes(points->positions), to_bytes(points->normals), to_bytes(points->radii),
                       to_bytes(points->colours));
}

PyMethodDef methods[] = {
    {"decode", decode, METH_VARARGS,
     "decode(data, radius_min, radius_max, count) -> (positions, normals, radii, colours)\n\n"
     "The columns of `count` points as bytes: 12, 12, 4 and 3 a point; no colours where there are none.\n"
     "ValueError: bytes that do not hold exactly that."},
    {nullptr, nullptr, 0, nullptr},
};

PyModuleDef module = {
    .m_base = PyModuleDef_HEAD_INIT,
    .m_name = "_draco",
    .m_doc = "Decodes the API's Draco points.",
    .m_size = 0,
    .m_methods = methods,
    .m_slots = nullptr,
    .m_traverse = nullptr,
    .m_clear = nullptr,
    .m_free = nullptr,
};

}  // namespace

PyMODINIT_FUNC PyInit__draco() { return PyModule_Create(&module); }
