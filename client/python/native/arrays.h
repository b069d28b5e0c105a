// Arrays of numpy from what C++ made, without copies, and the other way round.
#pragma once

#include <absl/status/statusor.h>
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/mesh/polygon_soup.h"

namespace curvecast::python {

/// Rows of an array that Python holds, contiguous.
template <typename T, int columns>
using Rows = nanobind::ndarray<const T, nanobind::shape<-1, columns>, nanobind::c_contig, nanobind::device::cpu>;
template <typename T>
using Values = nanobind::ndarray<const T, nanobind::shape<-1>, nanobind::c_contig, nanobind::device::cpu>;

/// An array of `columns` numbers of type T a row (none: one-dimensional) that owns `values`, a vector or a string.
template <typename T, typename Container>
nanobind::object array_of(Container values, std::size_t columns = 0) {
  const std::size_t rows = values.size() * sizeof(values[0]) / (sizeof(T) * (columns > 0 ? columns : 1));
  auto* const kept = new Container(std::move(values));
  const nanobind::capsule owner(kept, [](void* memory) noexcept { delete static_cast<Container*>(memory); });
  const std::size_t shape[] = {rows, columns};
  return nanobind::cast(nanobind::ndarray<nanobind::numpy, T>(kept->data(), columns > 0 ? 2 : 1, shape, owner));
}

/// Makes a soup of arrays. `colours`: V, or none. InvalidArgument: a coordinate that is not finite, an index out of range, a
/// column of another length; says which.
absl::StatusOr<PolygonSoup> to_soup(const Rows<double, 3>& vertices, const Rows<std::int64_t, 3>& faces,
                                    const nanobind::object& colours, const nanobind::dict& scalars);

}  // namespace curvecast::python
