// SPDX-License-Identifier: BSD-3-Clause
#include "fields/row_assignment.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "fields/matrix_products.h"

namespace lfm {
namespace {

constexpr int64_t kRowsAtOnce = 4096, kFunctionsAtOnce = 4096;

// Consecutive bases, one below the other.
struct Stack {
  int first = 0, end = 0;       // bases
  std::vector<int64_t> starts;  // of each in `functions`, and the end
  FunctionRows functions;
};

Stack StackFrom(const std::vector<FunctionRows>& bases, int first, int columns) {
  Stack stack;
  stack.first = stack.end = first;
  stack.starts = {0};
  while (stack.end < static_cast<int>(bases.size())) {
    const int64_t next = stack.starts.back() + bases[stack.end].rows;
    if (stack.end > first && next > kFunctionsAtOnce) break;
    stack.starts.push_back(next);
    ++stack.end;
  }
  // Bases of black rows have no functions; one of zeros holds as little.
  stack.functions = MakeFunctionRows(std::max<int64_t>(stack.starts.back(), 1), columns);
  for (int basis = first; basis < stack.end; ++basis) {
    for (int64_t t = 0; t < bases[basis].rows; ++t) {
      std::copy_n(bases[basis].Row(t), columns,
                  stack.functions.Row(stack.starts[basis - first] + t));
    }
  }
  return stack;
}

RowsView Part(RowsView rows, int64_t first) {
  return {rows.Row(first), std::min(kRowsAtOnce, rows.rows - first), rows.columns, rows.stride};
}

double HeldBy(const float* products, int64_t begin, int64_t end) {
  double held = 0;
  for (int64_t t = begin; t < end; ++t) held += double{products[t]} * products[t];
  return held;
}

}  // namespace

RowAssignment AssignRows(RowsView rows, const std::vector<double>& energies,
                         const std::vector<FunctionRows>& bases, const std::vector<int>& before) {
  constexpr double kBetter = 1e-6;
  RowAssignment best;
  best.cluster.assign(static_cast<size_t>(rows.rows), 0);
  best.held.assign(static_cast<size_t>(rows.rows), -1);
  std::vector<double> held_before(before.empty() ? 0 : best.held.size());
  for (int first = 0; first < static_cast<int>(bases.size());) {
    const Stack stack = StackFrom(bases, first, rows.columns);
    for (int64_t row = 0; row < rows.rows; row += kRowsAtOnce) {
      const FunctionRows products = TimesTransposed(Part(rows, row), stack.functions.View());
      ParallelChunks(products.rows, 128, [&](int64_t begin, int64_t end, int64_t) {
        for (int64_t i = begin; i < end; ++i) {
          for (int basis = stack.first; basis < stack.end; ++basis) {
            const int64_t place = basis - stack.first;
            const double held =
                HeldBy(products.Row(i), stack.starts[place], stack.starts[place + 1]);
            if (held > best.held[row + i]) {
              best.held[row + i] = held;
              best.cluster[row + i] = basis;
            }
            if (!before.empty() && before[row + i] == basis) held_before[row + i] = held;
          }
        }
      });
    }
    first = stack.end;
  }
  for (size_t row = 0; row < before.size(); ++row) {
    if (best.held[row] > held_before[row] + kBetter * energies[row]) continue;
    best.cluster[row] = before[row];
    best.held[row] = held_before[row];
  }
  return best;
}

std::vector<int64_t> SeedRows(RowsView rows, const std::vector<double>& energies, int count) {
  constexpr double kGolden = 0.6180339887498949, kNothing = 1e-10;
  std::vector<int64_t> seeds;
  std::vector<double> left = energies;
  double total = 0;
  for (const double energy : energies) total += energy;
  while (static_cast<int>(seeds.size()) < count) {
    double sum = 0;
    for (const double rest : left) sum += rest;
    if (sum <= kNothing * total) break;
    // A few at a time once there are many.
    const auto chosen = static_cast<int>(seeds.size());
    const int round = std::min(count - chosen, std::max(1, chosen / 8));
    const double offset = std::fmod((chosen + 1) * kGolden, 1.0);
    std::vector<FunctionRows> lines;
    double passed = 0;
    int next = 0;
    for (int64_t row = 0; row < rows.rows && next < round; ++row) {
      passed += left[row];
      if (left[row] <= 0 || passed < (next + offset) / round * sum) continue;
      while (next < round && passed >= (next + offset) / round * sum) ++next;
      seeds.push_back(row);
      FunctionRows line = GatherRows(rows, {row});
      const auto scale = 1 / std::sqrt(energies[row]);
      for (float& value : line.values) value = static_cast<float>(value * scale);
      lines.push_back(std::move(line));
    }
    if (lines.empty()) break;
    const RowAssignment nearest = AssignRows(rows, energies, lines, {});
    for (int64_t row = 0; row < rows.rows; ++row) {
      const double rest = energies[row] - nearest.held[row];
      left[row] = std::min(left[row], rest > kNothing * energies[row] ? rest : 0.0);
    }
  }
  return seeds;
}

}  // namespace lfm
