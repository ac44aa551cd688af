// SPDX-License-Identifier: BSD-3-Clause
#include "encode/factored_operator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/error.h"
#include "tests/encode/dense_oracle.h"
#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {
namespace {

constexpr double kProductError_rel = 1e-6;  // of ||F|| ||X||

Eigen::MatrixXf RandomMatrix(int rows, int cols, int seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(-1, 1);
  return Eigen::MatrixXf::NullaryExpr(rows, cols, [&] { return uniform(random); });
}

class FactoredOperator : public ::testing::Test {
 protected:
  // Patches of several sizes, and one triangle that nobody sees.
  FactoredOperator()
      : field_(MakeLightField(
            MakeSphere(1), 8, 60, [](int t) { return 3 + t % 4; }, GlossyAppearance)) {
    field_.triangles[5].photos.clear();
    field_.triangles[5].values.clear();
    field_.triangles[5].weights = {};
  }
  // Blended views of every other vertex are changed by what only the operator need not form.
  VertexOperator Operator(int vertex) {
    const VertexRings rings = ComputeVertexRings(field_.mesh);
    LightFieldSource source = field_.Source();
    if (vertex % 2 == 1) {
      source.change = [this](int triangle, int corner, const ViewWeights&) {
        std::vector<float> change(9 * field_.grid * field_.grid);
        for (size_t i = 0; i < change.size(); ++i) {
          change[i] =
              0.3f * std::sin(static_cast<float>(i) + 5.f * static_cast<float>(triangle + corner));
        }
        return change;
      };
    }
    return BuildVertexOperator(source, vertex, rings.Ring(vertex),
                               [this](int t) { return ArbitraryMean(field_, t); });
  }
  SyntheticLightField field_;
};

TEST_F(FactoredOperator, ProductsAgreeWithTheDenseMatrix) {
  for (int vertex = 0; vertex < static_cast<int>(field_.mesh.vertices.size()); ++vertex) {
    const VertexOperator f = Operator(vertex);
    const Eigen::MatrixXd dense = DenseMatrix(field_, f);
    for (const int width : {8, 16, 24}) {
      const RowMatrix x = RandomMatrix(f.cols(), width, vertex);
      const RowMatrix y = RandomMatrix(f.rows, width, vertex + 100);
      RowMatrix fx(f.rows, width), fty(f.cols(), width);
      Multiply(f, x.data(), width, fx.data());
      MultiplyTransposed(f, y.data(), width, fty.data());
      const double norm = dense.norm();
      EXPECT_LE((fx.cast<double>() - dense * x.cast<double>()).norm(),
                kProductError_rel * norm * x.norm());
      EXPECT_LE((fty.cast<double>() - dense.transpose() * y.cast<double>()).norm(),
                kProductError_rel * norm * y.norm());
    }
    EXPECT_GE(f.max_abs, dense.cwiseAbs().maxCoeff() * (1 - 1e-6));
  }
}

TEST_F(FactoredOperator, ScaledMapScalesColumns) {
  const VertexOperator f = Operator(0);
  const Eigen::MatrixXd dense = DenseMatrix(field_, f);
  std::vector<float> scale(f.directions);
  for (int q = 0; q < f.directions; ++q) scale[q] = 0.1f + 0.01f * static_cast<float>(q);
  const LinearMap map = ScaledMap(f, scale);
  Eigen::VectorXd diagonal(f.cols());
  for (int col = 0; col < f.cols(); ++col) diagonal[col] = scale[col % f.directions];
  const RowMatrix x = RandomMatrix(f.cols(), 8, 1), y = RandomMatrix(f.rows, 8, 2);
  RowMatrix fx(f.rows, 8), fty(f.cols(), 8);
  map.multiply(x.data(), 8, fx.data());
  map.multiply_transposed(y.data(), 8, fty.data());
  const Eigen::MatrixXd scaled = dense * diagonal.asDiagonal();
  EXPECT_LE((fx.cast<double>() - scaled * x.cast<double>()).norm(),
            kProductError_rel * scaled.norm() * x.norm());
  EXPECT_LE((fty.cast<double>() - scaled.transpose() * y.cast<double>()).norm(),
            kProductError_rel * scaled.norm() * y.norm());
}

TEST_F(FactoredOperator, EnergiesAgreeWithTheDenseMatrix) {
  for (const int vertex : {0, 3, 11}) {
    const VertexOperator f = Operator(vertex);
    const Eigen::MatrixXd dense = DenseMatrix(field_, f);
    std::vector<float> scale(f.directions);
    double scaled = 0;
    for (int q = 0; q < f.directions; ++q) {
      scale[q] = 1.f / static_cast<float>(1 + q);
      for (int c = 0; c < 3; ++c) {
        scaled += scale[q] * scale[q] * dense.col(c * f.directions + q).squaredNorm();
      }
    }
    const Energies energies = ComputeEnergies(f, scale);
    EXPECT_NEAR(energies.plain, dense.squaredNorm(), 1e-5 * dense.squaredNorm());
    EXPECT_NEAR(energies.scaled, scaled, 1e-5 * scaled);
  }
}

TEST_F(FactoredOperator, RejectsAMeanOfTheWrongSize) {
  const std::vector<int> ring = {0};
  EXPECT_THROW(BuildVertexOperator(field_.Source(), field_.mesh.triangles[0][0], ring,
                                   [](int) { return PatchMean(1); }),
               Error);
}

}  // namespace
}  // namespace lfm::testing
