#include "bindings.hpp"
#include "checks.hpp"
#include "sequence.hpp"

// A Data copies what it needs of its Model, so either may outlive the other.
void expose_data(py::module_ & module)
{
  expose_assignable_sequence<decltype(Data::v)>(module, "StdVec_Motion");

  py::class_<Data>(module, "Data", "Results of the algorithms on one model.")
    .def(py::init<const Model &>(), py::arg("model"))
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
}
