// SPDX-License-Identifier: BSD-3-Clause
#include "encode/product_kernels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace lfm::kernels {
namespace {

constexpr double kProductError_abs = 2e-5;

std::vector<float> RandomValues(size_t count, int seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(-1, 1);
  std::vector<float> values(count);
  for (float& value : values) value = uniform(random);
  return values;
}

class ProductKernels : public ::testing::TestWithParam<int> {};

// 37 and 29 leave remainders in every block size.
TEST_P(ProductKernels, MultiplyAgreesWithTheDefinition) {
  const int rows = 37, cols = 29, width = GetParam();
  const auto p = RandomValues(rows * cols, 1), z = RandomValues(cols * width, 2);
  std::vector<float> y(rows * width, 7.f);
  Multiply(p.data(), rows, cols, z.data(), width, y.data());
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < width; ++c) {
      double expected = 0;
      for (int j = 0; j < cols; ++j) expected += double{p[r * cols + j]} * z[j * width + c];
      ASSERT_NEAR(y[r * width + c], expected, kProductError_abs) << r << " " << c;
    }
  }
}

TEST_P(ProductKernels, MultiplyTransposedAgreesWithTheDefinition) {
  const int rows = 37, cols = 29, width = GetParam();
  const auto p = RandomValues(rows * cols, 3), y = RandomValues(rows * width, 4);
  std::vector<float> t(cols * width, 7.f);
  MultiplyTransposed(p.data(), rows, cols, y.data(), width, t.data());
  for (int j = 0; j < cols; ++j) {
    for (int c = 0; c < width; ++c) {
      double expected = 0;
      for (int r = 0; r < rows; ++r) expected += double{p[r * cols + j]} * y[r * width + c];
      ASSERT_NEAR(t[j * width + c], expected, kProductError_abs) << j << " " << c;
    }
  }
}

TEST_P(ProductKernels, GramAgreesWithTheDefinitionInDouble) {
  const int rows = 53, width = GetParam();
  const auto x = RandomValues(rows * width, 5);
  std::vector<double> g(width * width, 7.0);
  Gram(x.data(), rows, width, g.data());
  for (int i = 0; i < width; ++i) {
    for (int j = 0; j < width; ++j) {
      double expected = 0;
      for (int r = 0; r < rows; ++r) expected += double{x[r * width + i]} * x[r * width + j];
      ASSERT_NEAR(g[i * width + j], expected, 1e-13) << i << " " << j;
    }
  }
}

TEST_P(ProductKernels, WeightsGoBothWays) {
  const int views = 5, directions = 11, channels = 3, width = GetParam();
  std::vector<uint16_t> view;
  std::vector<int> offsets(views + 1, 0);
  std::vector<uint16_t> direction_by_view;
  std::vector<float> weight = RandomValues(3 * directions, 6), weight_by_view;
  for (int e = 0; e < 3 * directions; ++e) view.push_back(static_cast<uint16_t>(e * 7 % views));
  for (int v = 0; v < views; ++v) {
    for (int e = 0; e < 3 * directions; ++e) {
      if (view[e] != v) continue;
      direction_by_view.push_back(static_cast<uint16_t>(e / 3));
      weight_by_view.push_back(weight[e]);
    }
    offsets[v + 1] = static_cast<int>(weight_by_view.size());
  }
  const auto x = RandomValues(channels * directions * width, 7);
  const auto t = RandomValues(channels * views * width, 8);
  std::vector<float> z(channels * views * width, 7.f), out = x;
  DirectionsToViews({offsets.data(), direction_by_view.data(), weight_by_view.data()}, views,
                    directions, channels, x.data(), width, z.data());
  AddViewsToDirections(view.data(), weight.data(), views, directions, channels, t.data(), width,
                       out.data());
  std::vector<double> z_expected(z.size(), 0.0), out_expected(x.begin(), x.end());
  for (int c = 0; c < channels; ++c) {
    for (int e = 0; e < 3 * directions; ++e) {
      for (int w = 0; w < width; ++w) {
        const int at_view = (c * views + view[e]) * width + w;
        const int at_direction = (c * directions + e / 3) * width + w;
        z_expected[at_view] += double{weight[e]} * x[at_direction];
        out_expected[at_direction] += double{weight[e]} * t[at_view];
      }
    }
  }
  for (size_t i = 0; i < z.size(); ++i) ASSERT_NEAR(z[i], z_expected[i], kProductError_abs);
  for (size_t i = 0; i < out.size(); ++i) ASSERT_NEAR(out[i], out_expected[i], kProductError_abs);
}

INSTANTIATE_TEST_SUITE_P(Widths, ProductKernels, ::testing::Values(8, 16, 24));

}  // namespace
}  // namespace lfm::kernels
