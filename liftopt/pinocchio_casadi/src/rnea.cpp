// Inverse dynamics.
#include <pinocchio/algorithm/rnea.hpp>

#include "bindings.hpp"
#include "checks.hpp"

namespace
{
  SX rnea(const Model & model, Data & data, const SX & q, const SX & v, const SX & a)
  {
    check_data(model, data);
    return to_sx(
      pinocchio::rnea(model, data, to_q(model, q), to_tangent(model, v, "v"), to_tangent(model, a, "a")));
  }

  SX rnea_with_forces(
    const Model & model, Data & data, const SX & q, const SX & v, const SX & a, const py::sequence & fext)
  {
    check_data(model, data);
    return to_sx(pinocchio::rnea(
      model, data, to_q(model, q), to_tangent(model, v, "v"), to_tangent(model, a, "a"), to_forces(model, fext)));
  }
} // namespace

void expose_rnea(py::module_ & module)
{
  using py::arg;
  module.def(
    "rnea", &rnea, arg("model"), arg("data"), arg("q"), arg("v"), arg("a"),
    "Return the joint torques (nv, 1), also in data.tau.");
  module.def(
    "rnea", &rnea_with_forces, arg("model"), arg("data"), arg("q"), arg("v"), arg("a"), arg("fext"),
    "With a force on each joint in its local frame.");
}
