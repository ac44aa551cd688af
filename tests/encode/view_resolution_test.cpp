// SPDX-License-Identifier: BSD-3-Clause
#include "encode/view_resolution.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <random>

namespace lfm::testing {
namespace {

std::vector<float> RandomView(int grid, uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> value(-3, 5);
  std::vector<float> view(size_t{3} * grid * grid);
  for (float& v : view) v = value(random);
  return view;
}

double SquaredDistance(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += std::pow(static_cast<double>(a[i]) - b[i], 2);
  return sum;
}

TEST(ViewResolution, GridsAreHalvedTwiceAtMost) {
  EXPECT_EQ(ViewGridLevels(16), (std::vector<int>{16, 8, 4}));
  EXPECT_EQ(ViewGridLevels(64), (std::vector<int>{64, 32, 16}));
  EXPECT_EQ(ViewGridLevels(12), (std::vector<int>{12, 6}));
  EXPECT_EQ(ViewGridLevels(8), (std::vector<int>{8, 4}));
  EXPECT_EQ(ViewGridLevels(33), (std::vector<int>{33}));
  EXPECT_EQ(ViewGridLevels(2), (std::vector<int>{2}));
}

// What is linear along both sides has no other form on any grid; its corners stay.
TEST(ViewResolution, KeepsWhatIsBilinear) {
  const auto bilinear = [](int grid) {
    std::vector<float> view;
    for (int y = 0; y < grid; ++y) {
      for (int x = 0; x < grid; ++x) {
        const float u = static_cast<float>(x) / (grid - 1), v = static_cast<float>(y) / (grid - 1);
        view.insert(view.end(), {u - 2 * v, u * v, 3 - u});
      }
    }
    return view;
  };
  for (const int from : {2, 4, 7, 16}) {
    for (const int to : {2, 3, 8, 16}) {
      EXPECT_LT(SquaredDistance(ViewResampler(from, to)(bilinear(from)), bilinear(to)), 1e-9)
          << from << " to " << to;
    }
  }
}

TEST(ViewResolution, CoarserIsTheLeastSquaresFit) {
  constexpr int kFine = 16, kCoarse = 8;
  const std::vector<float> view = RandomView(kFine, 3);
  const std::vector<float> coarse = ViewResampler(kFine, kCoarse)(view);
  const ViewResampler back(kCoarse, kFine);
  // The oracle: a dense solve over the columns that unit maps give.
  Eigen::MatrixXd columns(3 * kFine * kFine, 3 * kCoarse * kCoarse);
  for (int i = 0; i < columns.cols(); ++i) {
    std::vector<float> unit(columns.cols(), 0.f);
    unit[i] = 1;
    const std::vector<float> fine = back(unit);
    for (int j = 0; j < columns.rows(); ++j) columns(j, i) = fine[j];
  }
  const Eigen::VectorXd wanted =
      Eigen::Map<const Eigen::VectorXf>(view.data(), columns.rows()).cast<double>();
  const Eigen::VectorXd best = columns.householderQr().solve(wanted);
  for (int i = 0; i < columns.cols(); ++i) EXPECT_NEAR(coarse[i], best[i], 1e-4);
}

TEST(ViewResolution, InterpolatesAsMapsAreRead) {
  const std::vector<float> view = RandomView(4, 5);
  const std::vector<float> fine = ViewResampler(4, 10)(view);  // every third texel is one of view
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) {
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(fine[3 * (30 * y + 3 * x) + c], view[3 * (4 * y + x) + c], 1e-5);
      }
    }
  }
  const float between = fine[3 * (10 * 1 + 2) + 1];  // a third down, two thirds to the right
  const auto at = [&](int x, int y) { return view[3 * (4 * y + x) + 1]; };
  EXPECT_NEAR(between, (2 * (at(0, 0) + 2 * at(1, 0)) + at(0, 1) + 2 * at(1, 1)) / 9, 1e-5);
  EXPECT_EQ(ViewResampler(4, 4)(view), view);
}

}  // namespace
}  // namespace lfm::testing
