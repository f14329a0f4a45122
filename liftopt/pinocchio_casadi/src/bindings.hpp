// One function for each group of names that the module exposes.
#pragma once

#include <pybind11/pybind11.h>

void expose_spatial(pybind11::module_ & module);
void expose_inertia(pybind11::module_ & module);
void expose_model(pybind11::module_ & module);
void expose_data(pybind11::module_ & module);
void expose_rnea(pybind11::module_ & module);
void expose_rnea_derivatives(pybind11::module_ & module);
void expose_kinematics(pybind11::module_ & module);
void expose_frames(pybind11::module_ & module);
void expose_jacobians(pybind11::module_ & module);
void expose_crba(pybind11::module_ & module);
