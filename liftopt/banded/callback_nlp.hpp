// A problem whose functions are Python's: for kernels that no compiler has made, and for any other problem.
#pragma once

#include <pybind11/functional.h>
#include <pybind11/numpy.h>

#include <algorithm>
#include <stdexcept>

#include "sparse_nlp.hpp"

namespace banded {

class CallbackNlp : public SparseNlp {
 public:
  using Array = pybind11::array_t<double, pybind11::array::c_style | pybind11::array::forcecast>;

  // `evaluate`: x -> (f, g). `differentiate`: (x, multipliers, scale) -> (gradient of scale f, nonzeros of the Jacobian
  // by rows, upper nonzeros of the Hessian by rows).
  CallbackNlp(pybind11::function evaluate, pybind11::function differentiate, Sparse jacobian_pattern,
              Sparse hessian_pattern)
      : SparseNlp(std::move(jacobian_pattern), std::move(hessian_pattern)), evaluate_(std::move(evaluate)),
        differentiate_(std::move(differentiate)) {}

  double evaluate(const double* x, double* g) override {
    pybind11::gil_scoped_acquire python;
    const pybind11::tuple values = evaluate_(Array(unknowns(), x));
    copy(values[1], g, rows());
    return values[0].cast<double>();
  }

  void differentiate(const double* x, const double* multipliers, double scale) override {
    pybind11::gil_scoped_acquire python;
    const pybind11::tuple values = differentiate_(Array(unknowns(), x), Array(rows(), multipliers), scale);
    copy(values[0], gradient.data(), unknowns());
    copy(values[1], jacobian.value.data(), jacobian.nonzeros());
    copy(values[2], hessian.value.data(), hessian.nonzeros());
  }

 private:
  static void copy(const pybind11::handle& from, double* to, int size) {
    const Array array = from.cast<Array>();
    if (array.size() != size) throw std::length_error("a callback returned an array of another length");
    std::copy_n(array.data(), size, to);
  }

  pybind11::function evaluate_, differentiate_;
};

}  // namespace banded
