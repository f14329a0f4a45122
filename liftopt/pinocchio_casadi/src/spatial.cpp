// Placements, motions and forces.
#include "bindings.hpp"
#include "convert.hpp"
#include "pinocchio_type.hpp"

namespace
{
  using Matrix4 = Eigen::Matrix<SX, 4, 4>;

  SE3 se3_from_homogeneous(const SX & homogeneous)
  {
    const Matrix4 matrix = to_matrix<4, 4>(homogeneous, "array");
    return SE3(matrix.topLeftCorner<3, 3>(), matrix.topRightCorner<3, 1>());
  }

  SX homogeneous(const SE3 & placement)
  {
    return to_sx(placement.toHomogeneousMatrix());
  }

  SX act_on_point(const SE3 & placement, const SX & point)
  {
    return to_sx(placement.act(to_vector<3>(point, "point")));
  }

  SX inverse_act_on_point(const SE3 & placement, const SX & point)
  {
    return to_sx(placement.actInv(to_vector<3>(point, "point")));
  }

  // MotionTpl and ForceTpl have the same face: two 3-vectors, linear first.
  template<typename Spatial>
  py::class_<Spatial> expose_vector6(py::module_ & module, const char * name, const char * doc)
  {
    return py::class_<Spatial>(module, name, doc)
      .def(py::init([] { return Spatial(Spatial::Zero()); }))
      .def(py::init<const Spatial &>(), py::arg("clone"))
      .def(
        py::init([name](const py::object & clone) {
          require_pinocchio(clone, name);
          return Spatial(to_vector<6>(clone.attr("vector").cast<SX>(), "vector"));
        }),
        py::arg("clone"))
      .def(
        py::init([](const SX & linear, const SX & angular) {
          return Spatial(to_vector<3>(linear, "linear"), to_vector<3>(angular, "angular"));
        }),
        py::arg("linear"), py::arg("angular"))
      .def(py::init([](const SX & array) { return Spatial(to_vector<6>(array, "array")); }), py::arg("array"))
      .def_property(
        "linear", [](const Spatial & self) { return to_sx(self.linear()); },
        [](Spatial & self, const SX & value) { self.linear() = to_vector<3>(value, "linear"); })
      .def_property(
        "angular", [](const Spatial & self) { return to_sx(self.angular()); },
        [](Spatial & self, const SX & value) { self.angular() = to_vector<3>(value, "angular"); })
      .def_property(
        "vector", [](const Spatial & self) { return to_sx(self.toVector()); },
        [](Spatial & self, const SX & value) { self.toVector() = to_vector<6>(value, "vector"); })
      .def_property_readonly("np", [](const Spatial & self) { return to_sx(self.toVector()); })
      .def("setZero", [](Spatial & self) { self.setZero(); })
      .def("se3Action", [](const Spatial & self, const SE3 & M) { return Spatial(M.act(self)); }, py::arg("M"))
      .def(
        "se3ActionInverse", [](const Spatial & self, const SE3 & M) { return Spatial(M.actInv(self)); }, py::arg("M"))
      .def("__add__", [](const Spatial & a, const Spatial & b) { return Spatial(a + b); })
      .def("__sub__", [](const Spatial & a, const Spatial & b) { return Spatial(a - b); })
      .def("__neg__", [](const Spatial & self) { return Spatial(-self); })
      .def("__mul__", [](const Spatial & self, const SX & s) { return Spatial(self * to_scalar(s, "factor")); })
      .def("copy", [](const Spatial & self) { return Spatial(self); })
      .def("__copy__", [](const Spatial & self) { return Spatial(self); })
      .def_static("Zero", [] { return Spatial(Spatial::Zero()); });
  }
} // namespace

void expose_spatial(py::module_ & module)
{
  auto se3 = py::class_<SE3>(module, "SE3", "Placement: a (3, 3) rotation and a (3, 1) translation.");
  auto motion = expose_vector6<Motion>(module, "Motion", "Spatial motion: linear, then angular.");
  auto force = expose_vector6<Force>(module, "Force", "Spatial force: linear, then angular.");

  motion
    .def("dot", [](const Motion & self, const Force & f) { return SX(self.dot(f)); }, py::arg("f"))
    .def("cross", [](const Motion & self, const Motion & m) { return Motion(self.cross(m)); }, py::arg("m"))
    .def("cross", [](const Motion & self, const Force & f) { return Force(self.cross(f)); }, py::arg("f"));
  force.def("dot", [](const Force & self, const Motion & m) { return SX(self.dot(m)); }, py::arg("m"));

  se3.def(py::init([] { return SE3(SE3::Identity()); }))
    .def(py::init<const SE3 &>(), py::arg("clone"))
    .def(
      py::init([](const py::object & clone) {
        require_pinocchio(clone, "SE3");
        return se3_from_homogeneous(clone.attr("homogeneous").cast<SX>());
      }),
      py::arg("clone"))
    .def(
      py::init([](const SX & rotation, const SX & translation) {
        return SE3(to_matrix<3, 3>(rotation, "rotation"), to_vector<3>(translation, "translation"));
      }),
      py::arg("rotation"), py::arg("translation"))
    .def(py::init([](int) { return SE3(SE3::Identity()); }), py::arg("int"), "Init to identity.")
    .def(py::init(&se3_from_homogeneous), py::arg("array"))
    .def_property(
      "rotation", [](const SE3 & self) { return to_sx(self.rotation()); },
      [](SE3 & self, const SX & value) { self.rotation() = to_matrix<3, 3>(value, "rotation"); })
    .def_property(
      "translation", [](const SE3 & self) { return to_sx(self.translation()); },
      [](SE3 & self, const SX & value) { self.translation() = to_vector<3>(value, "translation"); })
    .def_property_readonly("homogeneous", &homogeneous)
    .def_property_readonly("np", &homogeneous)
    .def_property_readonly("action", [](const SE3 & self) { return to_sx(self.toActionMatrix()); })
    .def_property_readonly("actionInverse", [](const SE3 & self) { return to_sx(self.toActionMatrixInverse()); })
    .def_property_readonly("dualAction", [](const SE3 & self) { return to_sx(self.toDualActionMatrix()); })
    .def("inverse", [](const SE3 & self) { return SE3(self.inverse()); })
    .def("__invert__", [](const SE3 & self) { return SE3(self.inverse()); })
    .def("setIdentity", [](SE3 & self) { self.setIdentity(); })
    .def("copy", [](const SE3 & self) { return SE3(self); })
    .def("__copy__", [](const SE3 & self) { return SE3(self); })
    .def_static("Identity", [] { return SE3(SE3::Identity()); });

  for (const char * name : {"act", "__mul__"})
    se3.def(name, [](const SE3 & self, const SE3 & M) { return SE3(self.act(M)); }, py::arg("M"))
      .def(name, [](const SE3 & self, const Motion & motion) { return Motion(self.act(motion)); }, py::arg("motion"))
      .def(name, [](const SE3 & self, const Force & force) { return Force(self.act(force)); }, py::arg("force"))
      .def(name, &act_on_point, py::arg("point"));
  se3.def("actInv", [](const SE3 & self, const SE3 & M) { return SE3(self.actInv(M)); }, py::arg("M"))
    .def("actInv", [](const SE3 & self, const Motion & motion) { return Motion(self.actInv(motion)); }, py::arg("motion"))
    .def("actInv", [](const SE3 & self, const Force & force) { return Force(self.actInv(force)); }, py::arg("force"))
    .def("actInv", &inverse_act_on_point, py::arg("point"));
}
