// A vector inside a Model or a Data as a Python sequence of fixed length. Its items are references: assigning to an
// item's attribute changes the model. Never growing, it never invalidates one, and each keeps its owner alive.
#pragma once

#include <string>

#include <pybind11/pybind11.h>

namespace py = pybind11;

template<typename Vector>
void expose_sequence(py::module_ & module, const char * name)
{
  using Item = typename Vector::value_type;
  const auto at = [](Vector & self, py::ssize_t index) -> Item & {
    const auto size = static_cast<py::ssize_t>(self.size());
    const py::ssize_t wrapped = index < 0 ? index + size : index;
    if (wrapped < 0 || wrapped >= size)
      throw py::index_error("expected " + std::to_string(-size) + " to " + std::to_string(size - 1) + ", got " + std::to_string(index));
    return self[static_cast<std::size_t>(wrapped)];
  };
  py::class_<Vector>(module, name)
    .def("__len__", [](const Vector & self) { return self.size(); })
    .def("__getitem__", at, py::return_value_policy::reference_internal)
    .def("__setitem__", [at](Vector & self, py::ssize_t index, const Item & item) { at(self, index) = item; })
    .def(
      "__iter__",
      [](Vector & self) {
        return py::make_iterator<py::return_value_policy::reference_internal>(self.begin(), self.end());
      },
      py::keep_alive<0, 1>())
    .def("tolist", [](const py::object & self) { return py::list(self); });
}
