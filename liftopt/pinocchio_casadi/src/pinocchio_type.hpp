// Objects of the double-precision module `pinocchio`, reached by name so that no C++ ABI is shared with it.
#pragma once

#include <string>

#include <pybind11/pybind11.h>

namespace py = pybind11;

inline py::object pinocchio_attribute(const char * name)
{
  return py::module_::import("pinocchio").attr(name);
}

// Lets pybind11 try the next overload when the argument is something else.
inline void require_pinocchio(const py::handle & object, const char * type)
{
  if (!py::isinstance(object, pinocchio_attribute(type)))
    throw py::reference_cast_error();
}
