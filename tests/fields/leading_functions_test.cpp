// SPDX-License-Identifier: BSD-3-Clause
#include "fields/leading_functions.h"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/parallel.h"
#include "tests/fields/l1_problems.h"

namespace lfm {
namespace {

constexpr double kAligned_abs = 1e-3, kEnergy_rel = 1e-5;

TEST(LeadingFunctions, AreTheRightSingularVectors) {
  const FunctionRows tall = MakeReflectanceLike(300, 40, 1);
  const FunctionRows wide = TransposeRows(tall.View());
  for (const FunctionRows* matrix : {&tall, &wide}) {
    const Eigen::MatrixXd dense = ToDense(matrix->View());
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(dense, Eigen::ComputeThinV);
    const FunctionRows found = LeadingFunctions(matrix->View(), 4);
    ASSERT_EQ(found.rows, 4);
    double energy = 0;
    for (int t = 0; t < 4; ++t) {
      const Eigen::VectorXd function = ToDense(found.View()).row(t);
      EXPECT_NEAR(std::abs(function.dot(svd.matrixV().col(t))), 1, kAligned_abs) << t;
      EXPECT_NEAR(function.norm(), 1, 1e-6);
      energy += (dense * function).squaredNorm();
    }
    const double most = svd.singularValues().head(4).squaredNorm();
    EXPECT_NEAR(energy, most, kEnergy_rel * most);
  }
}

TEST(LeadingFunctions, AreNoMoreThanTheRank) {
  const FunctionRows low = MakeSpikedLowRank(30, 20, 3, 0, 2).matrix;
  EXPECT_EQ(LeadingFunctions(low.View(), 8).rows, 3);
  EXPECT_EQ(LeadingFunctions(MakeFunctionRows(4, 4).View(), 2).rows, 0);
  EXPECT_EQ(LeadingFunctions(MakeFunctionRows(0, 4).View(), 2).rows, 0);
  EXPECT_EQ(LeadingFunctions(MakeNoise(1, 5, 3).View(), 4).rows, 1);
  EXPECT_EQ(LeadingFunctions(MakeNoise(5, 1, 4).View(), 4).rows, 1);
}

TEST(LeadingFunctions, ScaleAndThreadsDoNotMatter) {
  const FunctionRows matrix = MakeReflectanceLike(500, 30, 5);
  SetThreadCount(1);
  const FunctionRows one = LeadingFunctions(matrix.View(), 3);
  SetThreadCount(3);
  EXPECT_EQ(LeadingFunctions(matrix.View(), 3).values, one.values);
  SetThreadCount(0);
  for (const float scale : {0x1p-90F, 0x1p90F}) {
    FunctionRows scaled = matrix;
    for (float& value : scaled.values) value *= scale;
    EXPECT_EQ(LeadingFunctions(scaled.View(), 3).values, one.values);
  }
  FunctionRows bad = matrix;
  bad.Row(3)[1] = std::numeric_limits<float>::infinity();
  EXPECT_THROW(LeadingFunctions(bad.View(), 3), Error);
}

}  // namespace
}  // namespace lfm
