// Frame and Model. The structure of a Model is fixed once it is built from a pinocchio.Model by the Python layer.
#include "bindings.hpp"
#include "checks.hpp"
#include "joints.hpp"
#include "pinocchio_type.hpp"
#include "sequence.hpp"

namespace
{
  constexpr int any_frame =
    pinocchio::JOINT | pinocchio::FIXED_JOINT | pinocchio::BODY | pinocchio::OP_FRAME | pinocchio::SENSOR;

  template<typename Items>
  py::list to_list(const Items & items)
  {
    py::list list;
    for (const auto & item : items)
      list.append(item);
    return list;
  }

  // The double-precision module's own vector types, as upstream's casadi module returns them.
  template<typename Items>
  auto pinocchio_vector(Items Model::* member, const char * type)
  {
    return [member, type](const Model & self) { return pinocchio_attribute(type)(to_list(self.*member)); };
  }

  void expose_frame(py::module_ & module)
  {
    py::class_<Frame>(module, "Frame", "A frame fixed to a joint.")
      .def(py::init<const Frame &>(), py::arg("clone"))
      .def(
        py::init([](
                   const std::string & name, std::size_t parent_joint, std::size_t parent_frame, const SE3 & placement,
                   int type, const Inertia & inertia) {
          return Frame(
            name, parent_joint, parent_frame, placement, static_cast<pinocchio::FrameType>(type), inertia);
        }),
        py::arg("name"), py::arg("parent_joint"), py::arg("parent_frame"), py::arg("placement"), py::arg("type"),
        py::arg("inertia") = Inertia(Inertia::Zero()))
      .def_readwrite("name", &Frame::name)
      .def_readonly("parentJoint", &Frame::parentJoint)
      .def_readonly("parentFrame", &Frame::parentFrame)
      .def_readwrite("placement", &Frame::placement)
      .def_readwrite("inertia", &Frame::inertia)
      .def_property_readonly(
        "type", [](const Frame & self) { return pinocchio_attribute("FrameType")(static_cast<int>(self.type)); });
  }

  std::size_t add_joint(
    Model & model, std::size_t parent, const std::string & type, const SX & axis, const SE3 & placement,
    const std::string & name)
  {
    return model.addJoint(parent, make_joint(type, to_vector<3>(axis, "axis")), placement, name);
  }

  void set_frames(Model & model, const py::sequence & frames)
  {
    model.frames.clear();
    for (const py::handle item : frames)
    {
      const auto & frame = item.cast<const Frame &>();
      check_index(static_cast<long long>(frame.parentJoint), model.njoints, "parent_joint");
      model.frames.push_back(frame);
    }
    model.nframes = static_cast<int>(model.frames.size());
  }
} // namespace

void expose_model(py::module_ & module)
{
  expose_frame(module);
  expose_assignable_sequence<decltype(Model::inertias)>(module, "StdVec_Inertia");
  expose_assignable_sequence<decltype(Model::jointPlacements)>(module, "StdVec_SE3");
  // A whole frame cannot be assigned: it might name a joint that the model does not have.
  expose_sequence<decltype(Model::frames)>(module, "StdVec_Frame");

  module.def("_supported_joints", [] { return to_list(supported_joints()); });

  py::class_<Model>(module, "Model", "Articulated rigid body model on casadi.SX.")
    .def(py::init<>())
    .def(py::init<const Model &>(), py::arg("clone"))
    .def("_add_joint", &add_joint)
    .def("_set_frames", &set_frames)
    .def_readwrite("name", &Model::name)
    .def_readonly("nq", &Model::nq)
    .def_readonly("nv", &Model::nv)
    .def_readonly("njoints", &Model::njoints)
    .def_readonly("nframes", &Model::nframes)
    .def_readonly("inertias", &Model::inertias)
    .def_readonly("jointPlacements", &Model::jointPlacements)
    .def_readonly("frames", &Model::frames)
    .def_readwrite("gravity", &Model::gravity)
    .def_property(
      "armature", [](const Model & self) { return to_sx(self.armature); },
      [](Model & self, const SX & value) { self.armature = to_tangent(self, value, "armature"); })
    .def_property_readonly("names", pinocchio_vector(&Model::names, "StdVec_StdString"))
    .def_property_readonly("parents", pinocchio_vector(&Model::parents, "StdVec_Index"))
    .def_property_readonly("idx_qs", pinocchio_vector(&Model::idx_qs, "StdVec_int"))
    .def_property_readonly("nqs", pinocchio_vector(&Model::nqs, "StdVec_int"))
    .def_property_readonly("idx_vs", pinocchio_vector(&Model::idx_vs, "StdVec_int"))
    .def_property_readonly("nvs", pinocchio_vector(&Model::nvs, "StdVec_int"))
    .def("createData", [](const Model & self) { return Data(self); })
    .def("getJointId", &Model::getJointId, py::arg("name"))
    .def("existJointName", &Model::existJointName, py::arg("name"))
    .def(
      "getFrameId",
      [](const Model & self, const std::string & name, int type) {
        return self.getFrameId(name, static_cast<pinocchio::FrameType>(type));
      },
      py::arg("name"), py::arg("type") = any_frame)
    .def(
      "existFrame",
      [](const Model & self, const std::string & name, int type) {
        return self.existFrame(name, static_cast<pinocchio::FrameType>(type));
      },
      py::arg("name"), py::arg("type") = any_frame);
}
