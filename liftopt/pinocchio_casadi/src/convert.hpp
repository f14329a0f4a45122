// casadi::SX to Eigen matrices of scalar SX and back; sizes are checked and named on the way in.
#pragma once

#include <string>
#include <vector>

#include "spatial_sx.hpp"
#include "sx_caster.hpp"

namespace py = pybind11;

// A default-constructed SX is 0 by 0; in a matrix that Pinocchio has not written yet it stands for zero.
inline casadi::SXElem scalar(const SX & x)
{
  return x.nnz() == 0 ? casadi::SXElem(0) : x.nonzeros().front();
}

template<typename Derived>
SX to_sx(const Eigen::MatrixBase<Derived> & matrix)
{
  std::vector<casadi::SXElem> entries;
  entries.reserve(static_cast<std::size_t>(matrix.size()));
  for (Eigen::Index col = 0; col < matrix.cols(); ++col)
    for (Eigen::Index row = 0; row < matrix.rows(); ++row)
      entries.push_back(scalar(matrix(row, col)));
  return SX::reshape(SX(entries), matrix.rows(), matrix.cols());
}

[[noreturn]] inline void refuse_size(const SX & x, const std::string & expected, const char * name)
{
  throw py::value_error(
    std::string(name) + ": expected " + expected + ", got " + std::to_string(x.size1()) + " x "
    + std::to_string(x.size2()));
}

inline SX to_scalar(const SX & x, const char * name)
{
  if (x.numel() != 1)
    refuse_size(x, "one number", name);
  return SX(scalar(x));
}

template<int Rows = Eigen::Dynamic>
Eigen::Matrix<SX, Rows, 1> to_vector(const SX & x, const char * name, Eigen::Index rows = Rows)
{
  const bool one_dimensional = x.size1() == 1 || x.size2() == 1 || x.numel() == 0;
  if (!one_dimensional || x.numel() != rows)
    refuse_size(x, std::to_string(rows) + " entries", name);
  const std::vector<casadi::SXElem> entries = densify(x).nonzeros();
  Eigen::Matrix<SX, Rows, 1> vector(rows);
  for (Eigen::Index i = 0; i < rows; ++i)
    vector[i] = SX(entries[static_cast<std::size_t>(i)]);
  return vector;
}

template<int Rows, int Cols>
Eigen::Matrix<SX, Rows, Cols> to_matrix(const SX & x, const char * name)
{
  if (x.size1() != Rows || x.size2() != Cols)
    refuse_size(x, std::to_string(Rows) + " x " + std::to_string(Cols), name);
  const std::vector<casadi::SXElem> entries = densify(x).nonzeros();
  Eigen::Matrix<SX, Rows, Cols> matrix;
  for (Eigen::Index k = 0; k < matrix.size(); ++k)
    matrix(k % Rows, k / Rows) = SX(entries[static_cast<std::size_t>(k)]);
  return matrix;
}
