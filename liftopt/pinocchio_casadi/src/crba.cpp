// Joint-space inertia matrix.
#include <pinocchio/algorithm/crba.hpp>

#include "bindings.hpp"
#include "checks.hpp"

void expose_crba(py::module_ & module)
{
  module.def(
    "crba",
    [](const Model & model, Data & data, const SX & q, int convention) {
      check_data(model, data);
      data.M.fill(SX(0));
      pinocchio::crba(model, data, to_q(model, q), static_cast<pinocchio::Convention>(convention));
      make_symmetric(data.M);
      return to_sx(data.M);
    },
    py::arg("model"), py::arg("data"), py::arg("q"), py::arg("convention") = static_cast<int>(pinocchio::Convention::LOCAL),
    "Return the joint-space inertia matrix (nv, nv), also in data.M.");
}
