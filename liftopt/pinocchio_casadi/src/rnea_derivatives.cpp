// Analytical derivatives of the inverse dynamics.
#include <pinocchio/algorithm/rnea-derivatives.hpp>

#include "bindings.hpp"
#include "checks.hpp"

namespace
{
  py::tuple results(Data & data)
  {
    make_symmetric(data.M);
    return py::make_tuple(to_sx(data.dtau_dq), to_sx(data.dtau_dv), to_sx(data.M));
  }

  py::tuple derivatives(const Model & model, Data & data, const SX & q, const SX & v, const SX & a)
  {
    check_data(model, data);
    pinocchio::computeRNEADerivatives(
      model, data, to_q(model, q), to_tangent(model, v, "v"), to_tangent(model, a, "a"));
    return results(data);
  }

  py::tuple derivatives_with_forces(
    const Model & model, Data & data, const SX & q, const SX & v, const SX & a, const py::sequence & fext)
  {
    check_data(model, data);
    pinocchio::computeRNEADerivatives(
      model, data, to_q(model, q), to_tangent(model, v, "v"), to_tangent(model, a, "a"), to_forces(model, fext));
    return results(data);
  }
} // namespace

void expose_rnea_derivatives(py::module_ & module)
{
  using py::arg;
  module.def(
    "computeRNEADerivatives", &derivatives, arg("model"), arg("data"), arg("q"), arg("v"), arg("a"),
    "Return (dtau_dq, dtau_dv, M), each (nv, nv); the first is with respect to the tangent space of q.");
  module.def(
    "computeRNEADerivatives", &derivatives_with_forces, arg("model"), arg("data"), arg("q"), arg("v"), arg("a"),
    arg("fext"), "With a force on each joint in its local frame.");
}
