// casadi.SX crosses between Python and C++ by the pointer that its SWIG proxy holds in `this`.
#pragma once

#include <casadi/core/sx.hpp>
#include <pybind11/pybind11.h>

namespace pybind11::detail
{
  template<>
  struct type_caster<::casadi::SX>
  {
    PYBIND11_TYPE_CASTER(::casadi::SX, const_name("casadi.SX"));

    // Whatever casadi.SX(...) takes is taken: numbers, sequences, numpy arrays, DM; an MX is not.
    bool load(handle source, bool convert)
    {
      const object type = sx_type();
      if (isinstance(source, type))
      {
        value = *pointer(source);
        return true;
      }
      if (!convert)
        return false;
      try
      {
        value = *pointer(type(source));
        return true;
      }
      catch (error_already_set &)
      {
        return false;
      }
    }

    static handle cast(const ::casadi::SX & x, return_value_policy, handle)
    {
      object result = sx_type()();
      *pointer(result) = x;
      return result.release();
    }

  private:
    static object sx_type()
    {
      return module_::import("casadi").attr("SX");
    }

    static ::casadi::SX * pointer(handle proxy)
    {
      const auto address = reinterpret_steal<object>(PyNumber_Long(proxy.attr("this").ptr()));
      if (!address)
        throw error_already_set();
      return static_cast<::casadi::SX *>(PyLong_AsVoidPtr(address.ptr()));
    }
  };
} // namespace pybind11::detail
