#include "joints.hpp"

#include <functional>
#include <map>
#include <stdexcept>

namespace
{
  using Axis = Eigen::Matrix<SX, 3, 1>;
  using Maker = std::function<JointModel(const Axis &)>;

  template<typename Joint>
  std::pair<const std::string, Maker> aligned()
  {
    return {Joint::classname(), [](const Axis &) { return JointModel(Joint()); }};
  }

  // Its own constructor from an axis would normalise it, and a square root has no place in the graph.
  template<typename Joint>
  std::pair<const std::string, Maker> unaligned()
  {
    return {Joint::classname(), [](const Axis & axis) {
              Joint joint;
              joint.axis = axis;
              return JointModel(joint);
            }};
  }

  const std::map<std::string, Maker> & makers()
  {
    using namespace pinocchio;
    static const std::map<std::string, Maker> table{
      aligned<JointModelRevoluteTpl<SX, 0, 0>>(),
      aligned<JointModelRevoluteTpl<SX, 0, 1>>(),
      aligned<JointModelRevoluteTpl<SX, 0, 2>>(),
      unaligned<JointModelRevoluteUnalignedTpl<SX, 0>>(),
      aligned<JointModelPrismaticTpl<SX, 0, 0>>(),
      aligned<JointModelPrismaticTpl<SX, 0, 1>>(),
      aligned<JointModelPrismaticTpl<SX, 0, 2>>(),
      unaligned<JointModelPrismaticUnalignedTpl<SX, 0>>(),
      aligned<JointModelSphericalTpl<SX, 0>>(),
      aligned<JointModelFreeFlyerTpl<SX, 0>>(),
    };
    return table;
  }
} // namespace

JointModel make_joint(const std::string & short_name, const Axis & axis)
{
  const auto maker = makers().find(short_name);
  if (maker == makers().end())
    throw std::invalid_argument("unsupported joint type " + short_name);
  return maker->second(axis);
}

std::vector<std::string> supported_joints()
{
  std::vector<std::string> names;
  for (const auto & maker : makers())
    names.push_back(maker.first);
  return names;
}
