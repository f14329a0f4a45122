// Jacobians of joints and frames, (6, nv), linear rows first.
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>

#include "bindings.hpp"
#include "checks.hpp"

namespace
{
  Matrix6X zeros(const Model & model)
  {
    return Matrix6X::Constant(6, model.nv, SX(0));
  }

  SX compute_joint_jacobians(const Model & model, Data & data, const SX & q)
  {
    check_data(model, data);
    return to_sx(pinocchio::computeJointJacobians(model, data, to_q(model, q)));
  }

  SX compute_joint_jacobians_in_place(const Model & model, Data & data)
  {
    check_data(model, data);
    return to_sx(pinocchio::computeJointJacobians(model, data));
  }

  SX joint_jacobian(const Model & model, const Data & data, long long joint_id, int reference_frame)
  {
    check_data(model, data);
    const auto joint = check_index(joint_id, model.njoints, "joint_id");
    Matrix6X jacobian = zeros(model);
    pinocchio::getJointJacobian(model, data, joint, check_reference_frame(reference_frame), jacobian);
    return to_sx(jacobian);
  }

  SX frame_jacobian(const Model & model, Data & data, long long frame_id, int reference_frame)
  {
    check_data(model, data);
    const auto frame = check_index(frame_id, model.nframes, "frame_id");
    Matrix6X jacobian = zeros(model);
    pinocchio::getFrameJacobian(model, data, frame, check_reference_frame(reference_frame), jacobian);
    return to_sx(jacobian);
  }

  SX placement_jacobian(
    const Model & model, Data & data, long long joint_id, const SE3 & placement, int reference_frame)
  {
    check_data(model, data);
    const auto joint = check_index(joint_id, model.njoints, "joint_id");
    Matrix6X jacobian = zeros(model);
    pinocchio::getFrameJacobian(model, data, joint, placement, check_reference_frame(reference_frame), jacobian);
    return to_sx(jacobian);
  }

  SX compute_frame_jacobian(const Model & model, Data & data, const SX & q, long long frame_id, int reference_frame)
  {
    check_data(model, data);
    const auto frame = check_index(frame_id, model.nframes, "frame_id");
    Matrix6X jacobian = zeros(model);
    pinocchio::computeFrameJacobian(
      model, data, to_q(model, q), frame, check_reference_frame(reference_frame), jacobian);
    return to_sx(jacobian);
  }
} // namespace

void expose_jacobians(py::module_ & module)
{
  using py::arg;
  constexpr int local = pinocchio::LOCAL;
  module.def("computeJointJacobians", &compute_joint_jacobians, arg("model"), arg("data"), arg("q"));
  module.def("computeJointJacobians", &compute_joint_jacobians_in_place, arg("model"), arg("data"));
  module.def(
    "getJointJacobian", &joint_jacobian, arg("model"), arg("data"), arg("joint_id"), arg("reference_frame"));
  module.def(
    "getFrameJacobian", &frame_jacobian, arg("model"), arg("data"), arg("frame_id"), arg("reference_frame"));
  module.def(
    "getFrameJacobian", &placement_jacobian, arg("model"), arg("data"), arg("joint_id"), arg("placement"),
    arg("reference_frame"));
  module.def(
    "computeFrameJacobian", &compute_frame_jacobian, arg("model"), arg("data"), arg("q"), arg("frame_id"),
    arg("reference_frame") = local);
}
