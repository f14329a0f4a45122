// Pinocchio's spatial algebra on casadi::SX.
#pragma once

#include <pinocchio/autodiff/casadi.hpp>

#include <pinocchio/spatial.hpp>

using SX = ::casadi::SX;
using SE3 = pinocchio::SE3Tpl<SX>;
using Motion = pinocchio::MotionTpl<SX>;
using Force = pinocchio::ForceTpl<SX>;
using Inertia = pinocchio::InertiaTpl<SX>;
