// Placements, velocities and accelerations of the frames.
#include <pinocchio/algorithm/frames.hpp>

#include "bindings.hpp"
#include "checks.hpp"

namespace
{
  using Getter = Motion (*)(
    const Model &, const Data &, pinocchio::JointIndex, const SE3 &, pinocchio::ReferenceFrame);

  Motion velocity(
    const Model & model, const Data & data, pinocchio::JointIndex joint, const SE3 & placement,
    pinocchio::ReferenceFrame reference_frame)
  {
    return pinocchio::getFrameVelocity(model, data, joint, placement, reference_frame);
  }

  Motion acceleration(
    const Model & model, const Data & data, pinocchio::JointIndex joint, const SE3 & placement,
    pinocchio::ReferenceFrame reference_frame)
  {
    return pinocchio::getFrameAcceleration(model, data, joint, placement, reference_frame);
  }

  Motion classical_acceleration(
    const Model & model, const Data & data, pinocchio::JointIndex joint, const SE3 & placement,
    pinocchio::ReferenceFrame reference_frame)
  {
    return pinocchio::getFrameClassicalAcceleration(model, data, joint, placement, reference_frame);
  }

  // Each getter takes a frame of the model, or a joint and a placement in it.
  void expose_getter(py::module_ & module, const char * name, Getter getter)
  {
    using py::arg;
    constexpr int local = pinocchio::LOCAL;
    module.def(
      name,
      [getter](const Model & model, const Data & data, long long frame_id, int reference_frame) {
        check_data(model, data);
        const Frame & frame = model.frames[check_index(frame_id, model.nframes, "frame_id")];
        return getter(model, data, frame.parentJoint, frame.placement, check_reference_frame(reference_frame));
      },
      arg("model"), arg("data"), arg("frame_id"), arg("reference_frame") = local);
    module.def(
      name,
      [getter](
        const Model & model, const Data & data, long long joint_id, const SE3 & placement, int reference_frame) {
        check_data(model, data);
        const auto joint = check_index(joint_id, model.njoints, "joint_id");
        return getter(model, data, joint, placement, check_reference_frame(reference_frame));
      },
      arg("model"), arg("data"), arg("joint_id"), arg("placement"), arg("reference_frame") = local);
  }

  void update_placements(const Model & model, Data & data)
  {
    check_data(model, data);
    pinocchio::updateFramePlacements(model, data);
  }

  SE3 update_placement(const Model & model, Data & data, long long frame_id)
  {
    check_data(model, data);
    return pinocchio::updateFramePlacement(model, data, check_index(frame_id, model.nframes, "frame_id"));
  }

  void forward_kinematics(const Model & model, Data & data, const SX & q)
  {
    check_data(model, data);
    pinocchio::framesForwardKinematics(model, data, to_q(model, q));
  }
} // namespace

void expose_frames(py::module_ & module)
{
  using py::arg;
  module.def("updateFramePlacements", &update_placements, arg("model"), arg("data"));
  module.def("updateFramePlacement", &update_placement, arg("model"), arg("data"), arg("frame_id"));
  module.def("framesForwardKinematics", &forward_kinematics, arg("model"), arg("data"), arg("q"));
  expose_getter(module, "getFrameVelocity", &velocity);
  expose_getter(module, "getFrameAcceleration", &acceleration);
  expose_getter(module, "getFrameClassicalAcceleration", &classical_acceleration);
}
