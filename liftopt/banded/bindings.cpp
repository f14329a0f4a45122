// The Python module _liftopt_banded.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <tuple>

#include "callback_nlp.hpp"
#include "dense.hpp"
#include "interior_point.hpp"
#include "kernel_nlp.hpp"

namespace py = pybind11;

namespace {

using banded::Sparse;
using banded::Vector;
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Integers = py::array_t<int, py::array::c_style | py::array::forcecast>;
// (rows, columns, first entry of each row, column of each entry, values)
using SparseArrays = std::tuple<int, int, Integers, Integers, Doubles>;

Vector vector_of(const Doubles& array) { return Vector(array.data(), array.data() + array.size()); }

std::vector<int> integers_of(const Integers& array) { return {array.data(), array.data() + array.size()}; }

Sparse sparse_of(const SparseArrays& arrays) {
  const auto& [rows, columns, start, index, value] = arrays;
  Sparse matrix{rows, columns, integers_of(start), integers_of(index), vector_of(value)};
  const bool whole = matrix.start.size() == static_cast<std::size_t>(rows) + 1 && matrix.start[0] == 0 &&
                     matrix.start[rows] == matrix.nonzeros() && matrix.value.size() == matrix.index.size();
  if (!whole) throw std::invalid_argument("not a matrix in compressed rows");
  for (int r = 0; r < rows; ++r)
    if (matrix.start[r] > matrix.start[r + 1]) throw std::invalid_argument("rows must not overlap");
  for (int c : matrix.index)
    if (c < 0 || c >= columns) throw std::invalid_argument("a column is out of range");
  return matrix;
}

banded::KernelPart part_of(const py::dict& given) {
  banded::KernelPart part;
  part.value = reinterpret_cast<banded::Kernel>(given["value"].cast<std::uintptr_t>());
  part.derivatives = reinterpret_cast<banded::Kernel>(given["derivatives"].cast<std::uintptr_t>());
  part.columns = {given["first"].cast<int>(), given["coordinates"].cast<int>(),
                  integers_of(given["forces"].cast<Integers>()), integers_of(given["others"].cast<Integers>())};
  part.n_c = given["n_c"].cast<int>();
  part.n_p = given["n_p"].cast<int>();
  part.n_squared = given["n_squared"].cast<int>();
  const auto pattern = [&](const char* name, std::vector<int>& rows, std::vector<int>& columns, int n_rows) {
    const auto [r, c] = given[name].cast<std::tuple<Integers, Integers>>();
    rows = integers_of(r);
    columns = integers_of(c);
    bool whole = rows.size() == columns.size();
    for (int row : rows) whole = whole && row >= 0 && row < n_rows;
    for (int column : columns) whole = whole && column >= 0 && column < part.columns.size();
    if (!whole) throw std::invalid_argument("a nonzero of a kernel is out of range");
  };
  pattern("jacobian", part.jacobian_row, part.jacobian_column, part.n_c);
  pattern("curvature", part.curvature_row, part.curvature_column, part.columns.size());
  return part;
}

banded::KnotRow row_of(const std::tuple<std::vector<std::tuple<int, int, double>>, Integers>& given) {
  banded::KnotRow row;
  for (const auto& [part, output, factor] : std::get<0>(given)) row.terms.push_back({part, output, factor});
  row.row = integers_of(std::get<1>(given));
  return row;
}

// Of rows neutral, squares below and above, fourth powers below and above.
std::vector<banded::RangeTerm> range_of(const Doubles& rows) {
  if (rows.ndim() != 2 || rows.shape(0) != 5) throw std::length_error("a term of a range has five numbers");
  std::vector<banded::RangeTerm> terms;
  const auto at = rows.unchecked<2>();
  for (py::ssize_t j = 0; j < rows.shape(1); ++j)
    terms.push_back({at(0, j), {at(1, j), at(2, j)}, {at(3, j), at(4, j)}});
  return terms;
}

std::shared_ptr<banded::KernelNlp> kernel_nlp(
    int lanes, const Doubles& weights, const Doubles& basis, const Integers& control, const Integers& force,
    const std::vector<py::dict>& parts,
    const std::vector<std::tuple<std::vector<std::tuple<int, int, double>>, Integers>>& rows,
    const SparseArrays& linear, const std::vector<std::tuple<std::vector<std::tuple<int, int>>, Integers>>& varied) {
  std::vector<banded::KernelPart> all;
  for (const py::dict& part : parts) all.push_back(part_of(part));
  std::vector<banded::KnotRow> knot_rows;
  for (const auto& row : rows) knot_rows.push_back(row_of(row));
  int n_varied = 0;
  for (const auto& [terms, at] : varied) {
    banded::KnotRow row;
    for (const auto& [part, output] : terms) row.terms.push_back({part, output, 0.0, n_varied++});
    row.row = integers_of(at);
    knot_rows.push_back(row);
  }
  banded::Knots knots(lanes, vector_of(weights), vector_of(basis), integers_of(control), integers_of(force));
  return std::make_shared<banded::KernelNlp>(std::move(knots), std::move(all), std::move(knot_rows),
                                             sparse_of(linear));
}

const char* name_of(banded::Status status) {
  switch (status) {
    case banded::Status::solved: return "Solve_Succeeded";
    case banded::Status::iterations: return "Maximum_Iterations_Exceeded";
    case banded::Status::time: return "User_Requested_Stop";
    case banded::Status::line_search: return "Line_Search_Failed";
    case banded::Status::infeasible: return "Infeasible_Problem_Detected";
    case banded::Status::beaten: return "Worse_Than_Incumbent";
    default: return "Invalid_Number_Detected";
  }
}

const double* check(const Doubles& array, int size) {
  if (array.size() != size) throw std::length_error("an array does not have the problem's size");
  return array.data();
}

py::dict solve(banded::InteriorPoint& solver, const banded::Nlp& nlp, const Doubles& lower_x, const Doubles& upper_x,
               const Doubles& lower_g, const Doubles& upper_g, const Doubles& x0,
               const std::optional<std::tuple<Doubles, Doubles>>& warm, const banded::Options& options) {
  const int n = nlp.unknowns(), m = nlp.rows();
  const double* warm_x = warm ? check(std::get<0>(*warm), n) : nullptr;
  const double* warm_g = warm ? check(std::get<1>(*warm), m) : nullptr;
  const double *lx = check(lower_x, n), *ux = check(upper_x, n), *lg = check(lower_g, m), *ug = check(upper_g, m);
  const double* start = check(x0, n);
  banded::Result result;
  {
    py::gil_scoped_release free;
    result = solver.solve(lx, ux, lg, ug, start, warm_x, warm_g, options);
  }
  const auto array = [](const Vector& v) { return Doubles(static_cast<py::ssize_t>(v.size()), v.data()); };
  using namespace py::literals;
  return py::dict("status"_a = name_of(result.status), "x"_a = array(result.x),
                  "bound_multipliers"_a = array(result.bound_multipliers),
                  "multipliers"_a = array(result.multipliers), "objective"_a = result.objective,
                  "error"_a = result.error, "iterations"_a = result.iterations,
                  "factorisations"_a = result.factorisations, "refinements"_a = result.refinements,
                  "evaluations"_a = result.evaluations, "seconds"_a = result.seconds,
                  "evaluation_seconds"_a = result.evaluation_seconds,
                  "assembly_seconds"_a = result.assembly_seconds,
                  "factorisation_seconds"_a = result.factorisation_seconds);
}

// Keeps the problem that its solver refers to.
struct Solver {
  Solver(std::shared_ptr<banded::Nlp> problem, std::vector<std::vector<int>> blocks)
      : nlp(std::move(problem)), point(*nlp, std::move(blocks)) {}
  std::shared_ptr<banded::Nlp> nlp;
  banded::InteriorPoint point;
};

}  // namespace

PYBIND11_MODULE(_liftopt_banded, module) {
  module.doc() = "An interior point for problems whose condensed Newton matrix is block banded.";
  module.def(
      "instructions",
      [] {
        std::vector<std::string> names;
        for (const banded::DenseOperations* variant : banded::runnable_operations()) names.push_back(variant->name);
        return names;
      },
      "Variants of the dense operations that this processor can run, the one used by default first.");
  module.def("choose_instructions", &banded::choose_operations, "Choose the variant of solvers made from now on.");
  py::class_<banded::Nlp, std::shared_ptr<banded::Nlp>>(module, "Nlp")
      .def(
          "evaluate",
          [](banded::Nlp& nlp, const Doubles& x) {
            const double* at = check(x, nlp.unknowns());
            Vector g(nlp.rows());
            double f = 0.0;
            {
              py::gil_scoped_release free;
              f = nlp.evaluate(at, g.data());
            }
            return py::make_tuple(f, Doubles(static_cast<py::ssize_t>(g.size()), g.data()));
          },
          py::arg("x"), "Objective and constraint rows at x.")
      .def(
          "row_sizes",
          [](banded::Nlp& nlp, const Doubles& x) {
            const double* at = check(x, nlp.unknowns());
            const Vector none(nlp.rows());
            Vector sizes(nlp.rows());
            {
              py::gil_scoped_release free;
              nlp.differentiate(at, none.data(), 1.0);
              nlp.row_sizes(sizes.data());
            }
            return Doubles(static_cast<py::ssize_t>(sizes.size()), sizes.data());
          },
          py::arg("x"), "The largest term of each constraint row's derivatives at x.");
  py::class_<banded::KernelNlp, banded::Nlp, std::shared_ptr<banded::KernelNlp>>(module, "KernelNlp")
      .def(py::init(&kernel_nlp), py::kw_only(), py::arg("lanes"), py::arg("weights"), py::arg("basis"),
           py::arg("control"), py::arg("force"), py::arg("parts"), py::arg("rows"), py::arg("linear"),
           py::arg("varied") = std::vector<std::tuple<std::vector<std::tuple<int, int>>, Integers>>{})
      .def(
          "set_parameters",
          [](banded::KernelNlp& nlp, int part, const Doubles& parameters, const Doubles& c_weight,
             const Doubles& y_weight, const std::optional<Doubles>& c_weight_below,
             const std::optional<Doubles>& range) {
            nlp.set_parameters(part, vector_of(parameters), vector_of(c_weight), vector_of(y_weight),
                               vector_of(c_weight_below.value_or(c_weight)),
                               range ? range_of(*range) : std::vector<banded::RangeTerm>());
          },
          py::arg("part"), py::arg("parameters"), py::arg("c_weight"), py::arg("y_weight"),
          py::arg("c_weight_below") = py::none(), py::arg("range") = py::none())
      .def("set_factors", [](banded::KernelNlp& nlp, const Doubles& factors) { nlp.set_factors(vector_of(factors)); },
           "Set the factors of the varied rows' terms, (terms, knots).");
  py::class_<banded::CallbackNlp, banded::Nlp, std::shared_ptr<banded::CallbackNlp>>(module, "CallbackNlp")
      .def(py::init([](py::function evaluate, py::function differentiate, const SparseArrays& jacobian,
                       const SparseArrays& hessian) {
             return std::make_shared<banded::CallbackNlp>(std::move(evaluate), std::move(differentiate),
                                                          sparse_of(jacobian), sparse_of(hessian));
           }),
           py::kw_only(), py::arg("evaluate"), py::arg("differentiate"), py::arg("jacobian"), py::arg("hessian"));
  py::class_<Solver>(module, "InteriorPoint")
      .def(py::init<std::shared_ptr<banded::Nlp>, std::vector<std::vector<int>>>(), py::arg("nlp"), py::arg("blocks"))
      .def("multiplications", [](const Solver& solver) { return solver.point.multiplications(); },
           "Multiplications of one factorisation.")
      .def(
          "solve",
          [](Solver& solver, const Doubles& lower_x, const Doubles& upper_x, const Doubles& lower_g,
             const Doubles& upper_g, const Doubles& x0, const std::optional<std::tuple<Doubles, Doubles>>& warm,
             double tolerance, double rough, double objective_scaling, double seconds, double incumbent, double mu,
             double push, int max_iterations, int predictions, int verbose) {
            const banded::Options options{tolerance, rough, objective_scaling, seconds, incumbent, mu, push,
                                          max_iterations, predictions, verbose};
            return solve(solver.point, *solver.nlp, lower_x, upper_x, lower_g, upper_g, x0, warm, options);
          },
          py::kw_only(), py::arg("lower_x"), py::arg("upper_x"), py::arg("lower_g"), py::arg("upper_g"),
          py::arg("x0"), py::arg("warm") = py::none(), py::arg("tolerance") = 1e-6, py::arg("rough") = 0.0,
          py::arg("objective_scaling") = 0.1, py::arg("seconds") = 1e20, py::arg("incumbent") = INFINITY,
          py::arg("mu") = 0.1, py::arg("push") = 1e-2, py::arg("max_iterations") = 500,
          py::arg("predictions") = 0, py::arg("verbose") = 0);
}
