// A vector inside a Model or a Data as a Python sequence of fixed length. Its items are references: assigning to an
// item's attribute changes the model. Never growing, it never invalidates one, and each keeps its owner alive.
#pragma once

#include <string>

#include <pybind11/pybind11.h>

namespace py = pybind11;

template<typename Vector>
typename Vector::value_type & item_at(Vector & self, py::ssize_t index)
{
  const auto size = static_cast<py::ssize_t>(self.size());
  const py::ssize_t wrapped = index < 0 ? index + size : index;
  if (wrapped < 0 || wrapped >= size)
    throw py::index_error(
      "index: expected " + std::to_string(-size) + " to " + std::to_string(size - 1) + ", got "
      + std::to_string(index));
  return self[static_cast<std::size_t>(wrapped)];
}

template<typename Vector>
py::class_<Vector> expose_sequence(py::module_ & module, const char * name)
{
  return py::class_<Vector>(module, name)
    .def("__len__", [](const Vector & self) { return self.size(); })
    .def("__getitem__", &item_at<Vector>, py::return_value_policy::reference_internal)
    .def(
      "__iter__",
      [](Vector & self) {
        return py::make_iterator<py::return_value_policy::reference_internal>(self.begin(), self.end());
      },
      py::keep_alive<0, 1>())
    .def("tolist", [](const py::object & self) { return py::list(self); });
}

template<typename Vector>
void expose_assignable_sequence(py::module_ & module, const char * name)
{
  using Item = typename Vector::value_type;
  expose_sequence<Vector>(module, name)
    .def("__setitem__", [](Vector & self, py::ssize_t index, const Item & item) { item_at(self, index) = item; });
}
