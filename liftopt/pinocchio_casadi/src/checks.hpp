// What Pinocchio asserts in a debug build, or not at all, is checked here: a wrong argument must not read out of bounds.
#pragma once

#include "convert.hpp"
#include "pinocchio_sx.hpp"

inline void check_data(const Model & model, const Data & data)
{
  if (
    data.oMi.size() != static_cast<std::size_t>(model.njoints)
    || data.oMf.size() != static_cast<std::size_t>(model.nframes) || data.tau.size() != model.nv)
    throw py::value_error("data: created for another model; call model.createData()");
}

inline std::size_t check_index(long long index, int size, const char * name)
{
  if (index < 0 || index >= size)
    throw py::index_error(
      std::string(name) + ": expected 0 to " + std::to_string(size - 1) + ", got " + std::to_string(index));
  return static_cast<std::size_t>(index);
}

inline pinocchio::ReferenceFrame check_reference_frame(int value)
{
  if (value < pinocchio::WORLD || value > pinocchio::LOCAL_WORLD_ALIGNED)
    throw py::value_error("reference_frame: expected WORLD, LOCAL or LOCAL_WORLD_ALIGNED");
  return static_cast<pinocchio::ReferenceFrame>(value);
}

inline VectorX to_q(const Model & model, const SX & q, const char * name = "q")
{
  return to_vector(q, name, model.nq);
}

inline VectorX to_tangent(const Model & model, const SX & v, const char * name)
{
  return to_vector(v, name, model.nv);
}

// One force for each joint, the universe included, as in Pinocchio.
inline ForceVector to_forces(const Model & model, const py::sequence & fext)
{
  if (fext.size() != static_cast<std::size_t>(model.njoints))
    throw py::value_error(
      "fext: expected " + std::to_string(model.njoints) + " forces (one a joint, the universe first), got "
      + std::to_string(fext.size()));
  ForceVector forces;
  forces.reserve(fext.size());
  for (const py::handle force : fext)
  {
    if (!py::isinstance<Force>(force))
      throw py::type_error("fext: expected pinocchio_casadi Force objects, got " + std::string(py::str(py::type::of(force))));
    forces.push_back(force.cast<const Force &>());
  }
  return forces;
}

// Pinocchio's algorithms fill the upper triangle only.
inline void make_symmetric(Data::MatrixXs & matrix)
{
  for (Eigen::Index col = 0; col < matrix.cols(); ++col)
    for (Eigen::Index row = col + 1; row < matrix.rows(); ++row)
      matrix(row, col) = matrix(col, row);
}
