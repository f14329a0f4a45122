// Placements, velocities and accelerations of the joints.
#include <pinocchio/algorithm/kinematics.hpp>

#include "bindings.hpp"
#include "checks.hpp"

namespace
{
  void placements(const Model & model, Data & data, const SX & q)
  {
    check_data(model, data);
    pinocchio::forwardKinematics(model, data, to_q(model, q));
  }

  void velocities(const Model & model, Data & data, const SX & q, const SX & v)
  {
    check_data(model, data);
    pinocchio::forwardKinematics(model, data, to_q(model, q), to_tangent(model, v, "v"));
  }

  void accelerations(const Model & model, Data & data, const SX & q, const SX & v, const SX & a)
  {
    check_data(model, data);
    pinocchio::forwardKinematics(model, data, to_q(model, q), to_tangent(model, v, "v"), to_tangent(model, a, "a"));
  }

  Motion joint_velocity(const Model & model, const Data & data, long long joint_id, int reference_frame)
  {
    check_data(model, data);
    const auto joint = check_index(joint_id, model.njoints, "joint_id");
    return pinocchio::getVelocity(model, data, joint, check_reference_frame(reference_frame));
  }

  Motion joint_acceleration(const Model & model, const Data & data, long long joint_id, int reference_frame)
  {
    check_data(model, data);
    const auto joint = check_index(joint_id, model.njoints, "joint_id");
    return pinocchio::getAcceleration(model, data, joint, check_reference_frame(reference_frame));
  }
} // namespace

void expose_kinematics(py::module_ & module)
{
  using py::arg;
  constexpr int local = pinocchio::LOCAL;
  module.def("forwardKinematics", &placements, arg("model"), arg("data"), arg("q"));
  module.def("forwardKinematics", &velocities, arg("model"), arg("data"), arg("q"), arg("v"));
  module.def("forwardKinematics", &accelerations, arg("model"), arg("data"), arg("q"), arg("v"), arg("a"));
  module.def(
    "getVelocity", &joint_velocity, arg("model"), arg("data"), arg("joint_id"), arg("reference_frame") = local);
  module.def(
    "getAcceleration", &joint_acceleration, arg("model"), arg("data"), arg("joint_id"),
    arg("reference_frame") = local);
}
