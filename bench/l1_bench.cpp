// SPDX-License-Identifier: BSD-3-Clause
// What solvers of least absolute error cost and reach (Yamada 2009, Section 3.2): lfm-bench-l1.
// One thread, its processor time, so that other programs count little. Excess is the objective over
// that of the exact optimum, minus 1. Data A is the paper's own test (random low rank, 10 % random
// entries), data B is like reflectance functions.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <functional>
#include <limits>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "core/parallel.h"
#include "fields/l1_linear_programme.h"
#include "fields/l1_optimum.h"
#include "fields/l1_reweighted.h"
#include "fields/leading_functions.h"
#include "fields/sparse_factorization.h"
#include "tests/fields/clp_oracle.h"
#include "tests/fields/l1_problems.h"

namespace lfm {
namespace {

constexpr int kColumns = 253, kRows = 500, kTerms = 4;

double ProcessorSeconds() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// The least of some runs: what others do to the caches only adds.
double SecondsOf(int runs, const std::function<void()>& work) {
  double least = std::numeric_limits<double>::infinity();
  for (int run = 0; run < runs; ++run) {
    const double begin = ProcessorSeconds();
    work();
    least = std::min(least, ProcessorSeconds() - begin);
  }
  return least;
}

double Sum(const std::vector<double>& errors) {
  return std::accumulate(errors.begin(), errors.end(), 0.0);
}

FunctionRows FirstRows(RowsView all, int64_t count) {
  std::vector<int64_t> which(static_cast<size_t>(count));
  std::iota(which.begin(), which.end(), 0);
  return GatherRows(all, which);
}

L1Options With(L1Solver solver, int iterations = 20) {
  L1Options options;
  options.solver = solver;
  options.iterations = iterations;
  return options;
}

struct Problem {
  char name;
  FunctionRows targets, basis;
};

double ExactError(const Problem& problem, RowsView targets) {
  return Sum(SolveL1(problem.basis.View(), targets, With(L1Solver::kExact)).errors);
}

struct Line {
  std::string solver;
  double seconds_a_row, excess;
};

void Print(const Line& line, double glpk_seconds) {
  std::printf("  %-42s %10.4f ms/row  %9.1fx GLPK  excess %9.2e\n", line.solver.c_str(),
              1e3 * line.seconds_a_row, glpk_seconds / line.seconds_a_row, line.excess);
}

/// SolveL1 on the first rows of the problem.
Line Measure(const std::string& name, const Problem& problem, const L1Options& options,
             int64_t rows, const std::vector<float>& start = {}) {
  const FunctionRows targets = FirstRows(problem.targets.View(), rows);
  L1Solution found;
  const double seconds = SecondsOf(rows == problem.targets.rows ? 5 : 1, [&] {
    found = SolveL1(problem.basis.View(), targets.View(), options, start);
  });
  return {name, seconds / static_cast<double>(rows),
          Sum(found.errors) / ExactError(problem, targets.View()) - 1};
}

Line MeasureClp(const std::string& name, const Problem& problem, ClpForm form, int64_t rows) {
  const FunctionRows targets = FirstRows(problem.targets.View(), rows);
  const Eigen::MatrixXd functions = ToDense(problem.basis.View());
  const Eigen::MatrixXd dense = ToDense(targets.View());
  double sum = 0;
  const double seconds = SecondsOf(1, [&] {
    for (Eigen::Index i = 0; i < dense.rows(); ++i) {
      sum += LeastErrorByClp(functions, dense.row(i), form);
    }
  });
  return {name, seconds / static_cast<double>(rows), sum / ExactError(problem, targets.View()) - 1};
}

void PrintReweighted(const Problem& problem, double glpk_seconds) {
  const double least = ExactError(problem, problem.targets.View());
  const std::pair<kernels::L1Level, const char*> levels[] = {
      {kernels::L1Level::kBaseline, "SSE2"},
      {kernels::L1Level::kAvx2, "AVX2"},
      {kernels::L1Level::kAvx512, "AVX-512"}};
  for (const auto& [level, name] : levels) {
    if (!kernels::HasL1Level(level)) {
      std::printf("  reweighted, %s: not on this machine\n", name);
      continue;
    }
    for (int iterations : {10, 20, 30, 50}) {
      L1Solution found;
      const double seconds = SecondsOf(9, [&] {
        found = SolveReweighted(problem.basis.View(), problem.targets.View(), iterations, {},
                                kernels::L1KernelsOf(level));
      });
      Print({std::string("reweighted, ") + name + ", " + std::to_string(iterations) + " iterations",
             seconds / kRows, Sum(found.errors) / least - 1},
            glpk_seconds);
    }
  }
}

/// The basis after an alternation: each number moved by about 1 %.
FunctionRows Moved(const FunctionRows& basis) {
  FunctionRows moved = basis;
  std::mt19937 engine(3);
  std::normal_distribution<float> noise(1, 0.01F);
  for (float& value : moved.values) value *= noise(engine);
  return moved;
}

void PrintSolvers(const Problem& problem) {
  std::printf("Data %c, %d x %d, %d functions by PCA\n", problem.name, kRows, kColumns, kTerms);
  const Line glpk =
      Measure("GLPK, the paper's programme", problem, With(L1Solver::kLinearProgramme), 30);
  Print(glpk, glpk.seconds_a_row);
  const double scale = glpk.seconds_a_row;
  Print(MeasureClp("Clp, the paper's programme", problem, ClpForm::kPrimal, 30), scale);
  Print(MeasureClp("Clp, its dual", problem, ClpForm::kDual, 30), scale);
  Print(Measure("quadratic programme (interior point)", problem,
                With(L1Solver::kQuadraticProgramme), 30),
        scale);
  Print(Measure("exact, from least squares", problem, With(L1Solver::kExact, 0), kRows), scale);
  Print(Measure("exact, after 20 iterations", problem, With(L1Solver::kExact), kRows), scale);
  Problem moved{problem.name, problem.targets, Moved(problem.basis)};
  const std::vector<float> exact =
      SolveL1(problem.basis.View(), problem.targets.View(), With(L1Solver::kExact)).weights;
  Print(Measure("exact, basis moved 1 %, from before", moved, With(L1Solver::kExact, 0), kRows,
                exact),
        scale);
  Print(Measure("reweighted, same, 5 iterations", moved, With(L1Solver::kReweighted, 5), kRows,
                exact),
        scale);
  L1Options positive;
  positive.sign = ResidualSign::kPositive;
  const FunctionRows some = FirstRows(problem.targets.View(), 100);
  const double seconds =
      SecondsOf(3, [&] { SolveL1(problem.basis.View(), some.View(), positive); });
  std::printf("  %-42s %10.4f ms/row\n", "positive residual, exact", 10 * seconds);
  PrintReweighted(problem, scale);
}

void PrintScaling() {
  std::printf("Columns of a row (data A, %d functions), ms/row\n", kTerms);
  std::printf("  %8s %10s %10s %10s %12s %14s\n", "columns", "GLPK", "Clp dual", "exact",
              "reweighted", "excess");
  for (int columns : {256, 1024, 4096}) {
    const SpikedLowRank data = MakeSpikedLowRank(64, columns, kTerms, 0.1, 5);
    const Problem problem{'A', data.matrix, Moved(data.basis)};
    const int few = columns > 1000 ? (columns > 4000 ? 1 : 4) : 16;
    const Line glpk = Measure("", problem, With(L1Solver::kLinearProgramme), few);
    const Line clp = MeasureClp("", problem, ClpForm::kDual, few);
    const Line exact = Measure("", problem, With(L1Solver::kExact), 64);
    const Line reweighted = Measure("", problem, {}, 64);
    std::printf("  %8d %10.2f %10.2f %10.3f %12.4f %14.2e  (%.0fx GLPK)\n", columns,
                1e3 * glpk.seconds_a_row, 1e3 * clp.seconds_a_row, 1e3 * exact.seconds_a_row,
                1e3 * reweighted.seconds_a_row, reweighted.excess,
                glpk.seconds_a_row / reweighted.seconds_a_row);
  }
}

/// The part of the residual below a thousandth.
double SmallPart(RowsView matrix, const SparseFactors& factors) {
  const int64_t terms = factors.basis.rows;
  int64_t small = 0;
  for (int64_t i = 0; i < matrix.rows; ++i) {
    for (int j = 0; j < matrix.columns; ++j) {
      double rest = matrix.Row(i)[j];
      for (int64_t t = 0; t < terms; ++t) {
        rest -= double{factors.weights[i * terms + t]} * factors.basis.Row(t)[j];
      }
      small += std::abs(rest) < 1e-3;
    }
  }
  return static_cast<double>(small) / static_cast<double>(matrix.rows * matrix.columns);
}

struct Factorization {
  SparseFactors factors;
  double seconds = 0;
};

Factorization Factorize(RowsView matrix, int terms, FactorStart start, const L1Options& l1) {
  SparseFactorizationOptions options{terms, start, 40, 1e-4, l1};
  Factorization result;
  result.seconds = SecondsOf(1, [&] { result.factors = FactorizeSparse(matrix, options); });
  return result;
}

void PrintFactorizations(const Problem& problem) {
  std::printf("Factorisation of data %c to convergence (1e-4), %d terms\n", problem.name, kTerms);
  const std::pair<L1Solver, const char*> solvers[] = {{L1Solver::kReweighted, "reweighted"},
                                                      {L1Solver::kExact, "exact"}};
  for (const FactorStart start : {FactorStart::kPca, FactorStart::kRandom}) {
    for (const auto& [solver, name] : solvers) {
      const Factorization done = Factorize(problem.targets.View(), kTerms, start, With(solver));
      std::printf(
          "  %-6s start, %-10s %2zu alternations %8.3f s  L1 %10.3f (start %10.3f)  "
          "%5.1f %% below 1e-3\n",
          start == FactorStart::kPca ? "PCA" : "random", name, done.factors.l1_error.size() - 1,
          done.seconds, done.factors.l1_error.back(), done.factors.l1_error.front(),
          100 * SmallPart(problem.targets.View(), done.factors));
    }
  }
}

/// The paper's comparison of its two programmes, ours beside: accuracy against sparseness, speed
/// against size.
void PrintProgrammes() {
  const std::pair<L1Solver, const char*> solvers[] = {{L1Solver::kLinearProgramme, "LP"},
                                                      {L1Solver::kQuadraticProgramme, "QP"},
                                                      {L1Solver::kReweighted, "reweighted"},
                                                      {L1Solver::kExact, "exact"}};
  std::printf(
      "Accuracy against sparseness, 40 x 40, 2 terms, random start: L1 error over that of "
      "the true E, and part below 1e-3\n");
  for (double spikes : {0.05, 0.1, 0.2, 0.3, 0.4}) {
    const SpikedLowRank data = MakeSpikedLowRank(40, 40, 2, spikes, 17);
    std::printf("  %4.0f %% spikes:", 100 * spikes);
    for (const auto& [solver, name] : solvers) {
      const Factorization done =
          Factorize(data.matrix.View(), 2, FactorStart::kRandom, With(solver));
      std::printf("  %s %.4f, %.1f %%", name, done.factors.l1_error.back() / data.spike_error,
                  100 * SmallPart(data.matrix.View(), done.factors));
    }
    std::printf("\n");
  }
  std::printf("Seconds against size, n x n, 10 %% spikes, random start\n");
  for (int terms : {2, 4}) {
    for (int size : {10, 20, 40, 80}) {
      const SpikedLowRank data = MakeSpikedLowRank(size, size, terms, 0.1, 23);
      std::printf("  n %3d, %d terms:", size, terms);
      for (const auto& [solver, name] : solvers) {
        const Factorization done =
            Factorize(data.matrix.View(), terms, FactorStart::kRandom, With(solver));
        std::printf("  %s %.4f (%zu)", name, done.seconds, done.factors.l1_error.size() - 1);
      }
      std::printf("\n");
    }
  }
}

void Run() {
  SetThreadCount(1);
  const FunctionRows spiked = MakeSpikedLowRank(kRows, kColumns, kTerms, 0.1, 1).matrix;
  const FunctionRows reflectance = MakeReflectanceLike(kRows, kColumns, 2);
  const Problem problems[] = {{'A', spiked, LeadingFunctions(spiked.View(), kTerms)},
                              {'B', reflectance, LeadingFunctions(reflectance.View(), kTerms)}};
  for (const Problem& problem : problems) PrintSolvers(problem);
  PrintScaling();
  for (const Problem& problem : problems) PrintFactorizations(problem);
  PrintProgrammes();
}

}  // namespace
}  // namespace lfm

int main() { lfm::Run(); }
