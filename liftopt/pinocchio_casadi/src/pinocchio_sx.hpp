// Pinocchio's model and data on casadi::SX. Only headers are used: nothing here depends on libpinocchio's ABI.
#pragma once

#include <vector>

#include "spatial_sx.hpp"

#include <pinocchio/multibody.hpp>
#include <pinocchio/multibody/joint.hpp>

namespace pinocchio
{
  // Compile time and memory grow with the number of joint types in the variant, so only those that
  // pinocchio_casadi supports are in it; joints.cpp refuses the others by name.
  template<typename S, int O>
  struct JointCollectionSXTpl
  {
    using Scalar = S;
    static constexpr int Options = O;

    using JointModelVariant = boost::variant<
      JointModelRevoluteTpl<S, O, 0>,
      JointModelRevoluteTpl<S, O, 1>,
      JointModelRevoluteTpl<S, O, 2>,
      JointModelRevoluteUnalignedTpl<S, O>,
      JointModelPrismaticTpl<S, O, 0>,
      JointModelPrismaticTpl<S, O, 1>,
      JointModelPrismaticTpl<S, O, 2>,
      JointModelPrismaticUnalignedTpl<S, O>,
      JointModelSphericalTpl<S, O>,
      JointModelFreeFlyerTpl<S, O>>;

    using JointDataVariant = boost::variant<
      JointDataRevoluteTpl<S, O, 0>,
      JointDataRevoluteTpl<S, O, 1>,
      JointDataRevoluteTpl<S, O, 2>,
      JointDataRevoluteUnalignedTpl<S, O>,
      JointDataPrismaticTpl<S, O, 0>,
      JointDataPrismaticTpl<S, O, 1>,
      JointDataPrismaticTpl<S, O, 2>,
      JointDataPrismaticUnalignedTpl<S, O>,
      JointDataSphericalTpl<S, O>,
      JointDataFreeFlyerTpl<S, O>>;
  };
} // namespace pinocchio

using Model = pinocchio::ModelTpl<SX, 0, pinocchio::JointCollectionSXTpl>;
using Data = pinocchio::DataTpl<SX, 0, pinocchio::JointCollectionSXTpl>;
using JointModel = pinocchio::JointModelTpl<SX, 0, pinocchio::JointCollectionSXTpl>;
using Frame = pinocchio::FrameTpl<SX>;
using ForceVector = std::vector<Force>;

using VectorX = Eigen::Matrix<SX, Eigen::Dynamic, 1>;
using Matrix6X = Data::Matrix6x;
