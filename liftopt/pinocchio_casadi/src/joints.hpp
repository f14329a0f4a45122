#pragma once

#include <string>

#include "pinocchio_sx.hpp"

// The joint of that Pinocchio short name; `axis` matters to unaligned joints only. Throws std::invalid_argument
// for a name that is not one of supported_joints().
JointModel make_joint(const std::string & short_name, const Eigen::Matrix<SX, 3, 1> & axis);

std::vector<std::string> supported_joints();
