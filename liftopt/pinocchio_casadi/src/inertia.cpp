#include "bindings.hpp"
#include "convert.hpp"
#include "pinocchio_type.hpp"

namespace
{
  using Symmetric3 = pinocchio::Symmetric3Tpl<SX>;
  using Matrix3 = Eigen::Matrix<SX, 3, 3>;

  // Entries of the lower triangle are taken; a symbolic matrix cannot be tested for symmetry.
  Symmetric3 to_symmetric(const SX & inertia)
  {
    const Matrix3 I = to_matrix<3, 3>(inertia, "inertia");
    return Symmetric3(I(0, 0), I(1, 0), I(1, 1), I(2, 0), I(2, 1), I(2, 2));
  }

  Inertia make_inertia(const SX & mass, const SX & lever, const SX & inertia)
  {
    return Inertia(to_scalar(mass, "mass"), to_vector<3>(lever, "lever"), to_symmetric(inertia));
  }

  SX matrix(const Inertia & self)
  {
    return to_sx(self.matrix());
  }
} // namespace

void expose_inertia(py::module_ & module)
{
  py::class_<Inertia>(module, "Inertia", "Mass, centre of mass and (3, 3) rotational inertia about it.")
    .def(py::init(&make_inertia), py::arg("mass"), py::arg("lever"), py::arg("inertia"))
    .def(py::init([] { return Inertia(Inertia::Zero()); }))
    .def(py::init<const Inertia &>(), py::arg("clone"))
    .def(
      py::init([](const py::object & clone) {
        require_pinocchio(clone, "Inertia");
        return make_inertia(
          clone.attr("mass").cast<SX>(), clone.attr("lever").cast<SX>(), clone.attr("inertia").cast<SX>());
      }),
      py::arg("clone"))
    .def_property(
      "mass", [](const Inertia & self) { return SX(self.mass()); },
      [](Inertia & self, const SX & value) { self.mass() = to_scalar(value, "mass"); })
    .def_property(
      "lever", [](const Inertia & self) { return to_sx(self.lever()); },
      [](Inertia & self, const SX & value) { self.lever() = to_vector<3>(value, "lever"); })
    .def_property(
      "inertia", [](const Inertia & self) { return to_sx(self.inertia().matrix()); },
      [](Inertia & self, const SX & value) { self.inertia() = to_symmetric(value); })
    .def("matrix", &matrix)
    .def_property_readonly("np", &matrix)
    .def("se3Action", [](const Inertia & self, const SE3 & M) { return Inertia(M.act(self)); }, py::arg("M"))
    .def("se3ActionInverse", [](const Inertia & self, const SE3 & M) { return Inertia(M.actInv(self)); }, py::arg("M"))
    .def("setZero", [](Inertia & self) { self.setZero(); })
    .def("setIdentity", [](Inertia & self) { self.setIdentity(); })
    .def("__add__", [](const Inertia & a, const Inertia & b) { return Inertia(a + b); })
    .def("__mul__", [](const Inertia & self, const Motion & v) { return Force(self * v); })
    .def("toDynamicParameters", [](const Inertia & self) { return to_sx(self.toDynamicParameters()); })
    .def("copy", [](const Inertia & self) { return Inertia(self); })
    .def("__copy__", [](const Inertia & self) { return Inertia(self); })
    .def_static(
      "FromDynamicParameters",
      [](const SX & parameters) {
        return Inertia(Inertia::FromDynamicParameters(to_vector<10>(parameters, "dynamic_parameters")));
      },
      py::arg("dynamic_parameters"))
    .def_static("Zero", [] { return Inertia(Inertia::Zero()); })
    .def_static("Identity", [] { return Inertia(Inertia::Identity()); });
}
