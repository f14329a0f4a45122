#include "bindings.hpp"

PYBIND11_MODULE(_liftopt_pinocchio_casadi, module)
{
  // Brings libcasadi into the process and the type that symbolic arguments have.
  pybind11::module_::import("casadi");

  module.doc() = "Pinocchio on casadi::SX; use it through pinocchio.casadi or liftopt.pinocchio_casadi.";
  module.attr("casadi_version") = LIFTOPT_CASADI_VERSION;
  module.attr("pinocchio_version") = LIFTOPT_PINOCCHIO_VERSION;

  expose_spatial(module);
  expose_inertia(module);
  expose_model(module);
  expose_data(module);
  expose_rnea(module);
  expose_rnea_derivatives(module);
  expose_kinematics(module);
  expose_frames(module);
  expose_jacobians(module);
  expose_crba(module);
}
