// Frame and Model. The structure of a Model is fixed once it is built from a pinocchio.Model by the Python layer.
#include "bindings.hpp"
#include "checks.hpp"
#include "joints.hpp"
#include "pinocchio_type.hpp"
#include "sequence.hpp"

namespace
{
  template<typename Items>
  py::list to_list(const Items & items)
  {
    py::list list;
    for (const auto & item : items)
      list.append(item);
    return list;
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
    for (const py::handle frame : frames)
      model.frames.push_back(frame.cast<const Frame &>());
    model.nframes = static_cast<int>(model.frames.size());
  }
} // namespace

void expose_model(py::module_ & module)
{
  expose_frame(module);
  expose_sequence<decltype(Model::inertias)>(module, "StdVec_Inertia");
  expose_sequence<decltype(Model::jointPlacements)>(module, "StdVec_SE3");
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
    .def_readonly("nbodies", &Model::nbodies)
    .def_readonly("nframes", &Model::nframes)
    .def_readonly("inertias", &Model::inertias)
    .def_readonly("jointPlacements", &Model::jointPlacements)
    .def_readonly("frames", &Model::frames)
    .def_readwrite("gravity", &Model::gravity)
    .def_property(
      "armature", [](const Model & self) { return to_sx(self.armature); },
      [](Model & self, const SX & value) { self.armature = to_tangent(self, value, "armature"); })
    .def_property_readonly(
      "names", [](const Model & self) { return pinocchio_attribute("StdVec_StdString")(to_list(self.names)); })
    .def_property_readonly(
      "parents", [](const Model & self) { return pinocchio_attribute("StdVec_Index")(to_list(self.parents)); })
    .def_property_readonly(
      "idx_qs", [](const Model & self) { return pinocchio_attribute("StdVec_int")(to_list(self.idx_qs)); })
    .def_property_readonly(
      "nqs", [](const Model & self) { return pinocchio_attribute("StdVec_int")(to_list(self.nqs)); })
    .def_property_readonly(
      "idx_vs", [](const Model & self) { return pinocchio_attribute("StdVec_int")(to_list(self.idx_vs)); })
    .def_property_readonly(
      "nvs", [](const Model & self) { return pinocchio_attribute("StdVec_int")(to_list(self.nvs)); })
    .def("getJointId", [](const Model & self, const std::string & name) { return self.getJointId(name); }, py::arg("name"))
    .def("existJointName", &Model::existJointName, py::arg("name"))
    .def("getFrameId", [](const Model & self, const std::string & name) { return self.getFrameId(name); }, py::arg("name"))
    .def("existFrame", [](const Model & self, const std::string & name) { return self.existFrame(name); }, py::arg("name"));
}
