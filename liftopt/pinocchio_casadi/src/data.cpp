#include "bindings.hpp"
#include "checks.hpp"
#include "sequence.hpp"

// A Data copies what it needs of its Model, so either may outlive the other.
void expose_data(py::module_ & module)
{
  expose_sequence<decltype(Data::v)>(module, "StdVec_Motion");

  auto data = py::class_<Data>(module, "Data", "Results of the algorithms on one model.");
  data.def(py::init<const Model &>(), py::arg("model"))
    .def_readonly("oMi", &Data::oMi)
    .def_readonly("oMf", &Data::oMf)
    .def_readonly("liMi", &Data::liMi)
    .def_readonly("v", &Data::v)
    .def_readonly("a", &Data::a)
    .def_property_readonly("tau", [](const Data & self) { return to_sx(self.tau); })
    .def_property_readonly("J", [](const Data & self) { return to_sx(self.J); })
    .def_property_readonly("M", [](const Data & self) { return to_sx(self.M); })
    .def_property_readonly("dtau_dq", [](const Data & self) { return to_sx(self.dtau_dq); })
    .def_property_readonly("dtau_dv", [](const Data & self) { return to_sx(self.dtau_dv); });

  const auto model = py::reinterpret_borrow<py::class_<Model>>(module.attr("Model"));
  py::class_<Model>(model).def("createData", [](const Model & self) { return Data(self); });
}
