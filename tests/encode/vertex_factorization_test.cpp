// SPDX-License-Identifier: BSD-3-Clause
#include "encode/vertex_factorization.h"

#include <gtest/gtest.h>

#include <cmath>

#include "encode/pca.h"
#include "encode/quantization.h"
#include "tests/encode/dense_oracle.h"
#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {
namespace {

PatchMean TrueMean(const SyntheticLightField& field, int triangle) {
  const auto& t = field.triangles[triangle];
  PatchMean mean(t.values.size() / std::max<size_t>(1, t.photos.size()));
  for (size_t row = 0; row < mean.size(); ++row) {
    double sum = 0;
    for (size_t v = 0; v < t.photos.size(); ++v) sum += t.values[row * t.photos.size() + v];
    mean[row] = static_cast<float>(sum / LightField::kOne / static_cast<double>(t.photos.size()));
  }
  return mean;
}

struct Ring {
  VertexOperator f;
  SharedSamples shared;
  Eigen::MatrixXd dense;
};

Ring MakeRing(const SyntheticLightField& field, int vertex) {
  const VertexRings rings = ComputeVertexRings(field.mesh);
  const auto mean = [&field](int t) { return TrueMean(field, t); };
  Ring ring;
  ring.f = BuildVertexOperator(field.Source(), vertex, rings.Ring(vertex), mean);
  std::vector<Eigen::Vector3i> triangles;
  std::vector<int> sizes;
  for (const RingBlock& block : ring.f.blocks) {
    triangles.push_back(field.mesh.triangles[block.triangle]);
    sizes.push_back(block.edge_samples);
  }
  ring.shared = FindSharedSamples(triangles, sizes);
  ring.dense = DenseMatrix(field, ring.f, mean);
  return ring;
}

// The decoded product U V^T of the first `terms` terms.
Eigen::MatrixXd Decoded(const Ring& ring, const std::vector<TermMaps>& maps, size_t terms) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(ring.f.rows, ring.f.cols());
  for (size_t k = 0; k < std::min(terms, maps.size()); ++k) {
    Eigen::VectorXd u(ring.f.rows), v(ring.f.cols());
    for (int row = 0; row < ring.f.rows; ++row) {
      u[row] = DecodeValue(maps[k].surface_range, maps[k].surface_codes[row]);
    }
    for (int col = 0; col < ring.f.cols(); ++col) {
      const int q = col % ring.f.directions, channel = col / ring.f.directions;
      v[col] = DecodeValue(maps[k].view_range, maps[k].view_codes[3 * q + channel]);
    }
    sum += u * v.transpose();
  }
  return sum;
}

class VertexFactorization : public ::testing::Test {
 protected:
  VertexFactorization()
      : field_(MakeLightField(
            MakeSphere(1), 8, 80, [](int t) { return t % 3 == 0 ? 5 : 9; }, GlossyAppearance)) {}
  SyntheticLightField field_;
};

TEST_F(VertexFactorization, ReportsTheErrorOfTheDecodedMaps) {
  for (const int vertex : {0, 4, 9}) {
    const Ring ring = MakeRing(field_, vertex);
    for (const int terms : {1, 3}) {
      const VertexTerms result = FactorizeVertex(ring.f, ring.shared, {.terms = terms});
      const double expected = (ring.dense - Decoded(ring, result.terms, terms)).squaredNorm();
      EXPECT_NEAR(result.squared_errors.front(), ring.dense.squaredNorm(),
                  1e-5 * ring.dense.squaredNorm());
      EXPECT_NEAR(result.squared_errors.back(), expected, 1e-5 * ring.dense.squaredNorm());
      EXPECT_EQ(result.entries, ring.dense.size());
    }
  }
}

TEST_F(VertexFactorization, EveryTermLowersTheError) {
  const Ring ring = MakeRing(field_, 4);
  const VertexTerms result = FactorizeVertex(ring.f, ring.shared, {.terms = 4});
  ASSERT_EQ(result.terms.size(), 4u);
  double before = ring.dense.squaredNorm();
  for (size_t k = 1; k <= 4; ++k) {
    const double error = (ring.dense - Decoded(ring, result.terms, k)).squaredNorm();
    EXPECT_LT(error, before) << k;
    before = error;
  }
  const VertexTerms fewer = FactorizeVertex(ring.f, ring.shared, {.terms = 2});
  EXPECT_NEAR((Decoded(ring, fewer.terms, 2) - Decoded(ring, result.terms, 2)).norm(), 0,
              0.02 * ring.dense.norm());
}

// The surface maps of the PCA, equal on shared samples, as columns.
Eigen::MatrixXd ContinuousLeft(const Ring& ring, const PcaResult& pca) {
  Eigen::MatrixXd left(ring.f.rows, pca.terms);
  for (int k = 0; k < pca.terms; ++k) {
    std::vector<float> u(ring.f.rows);
    for (int row = 0; row < ring.f.rows; ++row) u[row] = pca.left[row * pca.width + k];
    std::vector<PatchValues> patches;
    for (const RingBlock& block : ring.f.blocks) {
      patches.push_back({u.data() + block.first_row, true});
    }
    MakeContinuous(ring.shared, 1, patches);
    left.col(k) = Eigen::Map<const Eigen::VectorXf>(u.data(), ring.f.rows).cast<double>();
  }
  return left;
}

// Open loop: the same PCA, each factor split and quantised, no refit.
TEST_F(VertexFactorization, ClosedLoopIsNotWorseThanOpenLoop) {
  for (const int vertex : {0, 4, 9, 15}) {
    const Ring ring = MakeRing(field_, vertex);
    const VertexTerms closed =
        FactorizeVertex(ring.f, ring.shared, {.terms = 3, .guessed_weight = 1});
    const std::vector<float> ones(ring.f.directions, 1.f);
    const PcaResult pca = ComputePca(ScaledMap(ring.f, ones), {.terms = 3});
    const Eigen::MatrixXd left = ContinuousLeft(ring, pca);
    std::vector<TermMaps> open(pca.terms);
    for (int k = 0; k < pca.terms; ++k) {
      Eigen::VectorXf u = left.col(k).cast<float>(), v(ring.f.cols());
      for (int col = 0; col < ring.f.cols(); ++col) v[col] = pca.right[col * pca.width + k];
      const AlphaSplit split = SplitAlpha(u.cwiseAbs().maxCoeff(), v.cwiseAbs().maxCoeff());
      u *= static_cast<float>(split.surface);
      v *= static_cast<float>(split.view);
      open[k].surface_range = SurfaceRange(u.minCoeff(), u.maxCoeff());
      open[k].view_range = ViewRange(v.minCoeff(), v.maxCoeff());
      for (const float value : u) {
        open[k].surface_codes.push_back(QuantizeValue(open[k].surface_range, value));
      }
      open[k].view_codes.resize(v.size());
      for (int col = 0; col < ring.f.cols(); ++col) {
        const int q = col % ring.f.directions, channel = col / ring.f.directions;
        open[k].view_codes[3 * q + channel] = QuantizeValue(open[k].view_range, v[col]);
      }
    }
    const double open_error = (ring.dense - Decoded(ring, open, 3)).squaredNorm();
    EXPECT_LE(closed.squared_errors.back(), open_error) << vertex;
  }
}

TEST_F(VertexFactorization, QuantisationCostsLittle) {
  const Ring ring = MakeRing(field_, 4);
  const VertexTerms result =
      FactorizeVertex(ring.f, ring.shared, {.terms = 3, .guessed_weight = 1});
  const std::vector<float> ones(ring.f.directions, 1.f);
  const PcaResult pca = ComputePca(ScaledMap(ring.f, ones), {.terms = 3});
  const Eigen::MatrixXd basis = OrthonormalBasis(ContinuousLeft(ring, pca));
  const double best = ring.dense.squaredNorm() - (basis.transpose() * ring.dense).squaredNorm();
  const double levels = 255 * std::sqrt(std::max(0.0, result.squared_errors.back() - best) /
                                        static_cast<double>(ring.dense.size()));
  EXPECT_LT(levels, 0.5);
}

TEST_F(VertexFactorization, SurfaceMapsAreZeroAtTheFarEdges) {
  const Ring ring = MakeRing(field_, 4);
  const VertexTerms result = FactorizeVertex(ring.f, ring.shared, {.terms = 2});
  for (const TermMaps& maps : result.terms) {
    for (const RingBlock& block : ring.f.blocks) {
      for (int s = 0; s < block.samples; ++s) {
        if (block.hat[s] != 0) continue;
        ASSERT_EQ(DecodeValue(maps.surface_range, maps.surface_codes[block.first_row + s]), 0.f);
      }
    }
  }
}

TEST_F(VertexFactorization, DownWeightedDirectionsFitTheSeenOnesBetter) {
  const Ring ring = MakeRing(field_, 4);
  const std::vector<float> scale = ColumnScale(ring.f, 0.0);
  const auto seen_error = [&](double weight) {
    const VertexTerms result =
        FactorizeVertex(ring.f, ring.shared, {.terms = 1, .guessed_weight = weight});
    const Eigen::MatrixXd error = ring.dense - Decoded(ring, result.terms, 1);
    double sum = 0;
    for (int col = 0; col < ring.f.cols(); ++col) {
      sum += std::pow(scale[col % ring.f.directions], 2) * error.col(col).squaredNorm();
    }
    return sum;
  };
  EXPECT_LE(seen_error(0.02), seen_error(1.0) * 1.0001);
}

TEST_F(VertexFactorization, ColumnWeightsAreSharesOfSeenSamples) {
  const Ring ring = MakeRing(field_, 4);
  const std::vector<float> scale = ColumnScale(ring.f, 0.25);
  double samples = 0, seen = 0;
  for (const RingBlock& block : ring.f.blocks) {
    samples += block.samples;
    seen += block.seen[3] ? block.samples : 0;
  }
  EXPECT_NEAR(scale[3] * scale[3], 0.25 + 0.75 * seen / samples, 1e-6);
}

TEST_F(VertexFactorization, RankOneNeedsOneTerm) {
  const Eigen::Vector3d tint(1, 0.8, 0.6);
  const SyntheticLightField field = MakeLightField(
      MakeSphere(1), 8, 80, [](int) { return 7; },
      [&](const Eigen::Vector3d& p, const Eigen::Vector3d& to_eye) -> Eigen::Vector3d {
        const double surface = 0.5 + 0.3 * std::sin(0.1 * p.x());
        return Eigen::Vector3d::Constant(0.3) + surface * (0.3 + 0.2 * to_eye.z()) * tint;
      });
  // With the same views and weights for every triangle F is of rank one (times the mean's offset).
  SyntheticLightField same = field;
  const VertexRings rings = ComputeVertexRings(same.mesh);
  const int first = rings.triangles[rings.offsets[4]];
  for (int e = rings.offsets[4]; e < rings.offsets[5]; ++e) {
    auto& triangle = same.triangles[rings.triangles[e]];
    const auto& model = same.triangles[first];
    std::vector<uint16_t> values;
    for (size_t s = 0; s < model.values.size() / model.photos.size(); ++s) {
      const double surface = 0.2 + 0.05 * static_cast<double>(s / 3 % 7);
      for (const uint16_t photo : model.photos) {
        const double view = 0.5 + 0.4 * std::sin(photo) * tint[static_cast<int>(s % 3)];
        values.push_back(static_cast<uint16_t>(std::lround(surface * view * LightField::kOne)));
      }
    }
    const auto weights = model.weights[0];
    triangle.photos = model.photos;
    triangle.values = values;
    triangle.weights = {weights, weights, weights};
  }
  const Ring ring = MakeRing(same, 4);
  const VertexTerms result = FactorizeVertex(ring.f, ring.shared, {.terms = 3});
  EXPECT_GT(result.singular_value_share[0], 0.999);
  const VertexTerms one = FactorizeVertex(ring.f, ring.shared, {.terms = 1});
  EXPECT_LT(255 * std::sqrt(one.squared_errors.back() / static_cast<double>(one.entries)), 1.0);
}

// A hole in the ring: the fit of the rest must not suffer, and the maps must not drop to zero in
// it.
TEST_F(VertexFactorization, GoesOnIntoTrianglesThatNobodySaw) {
  const Ring whole = MakeRing(field_, 4);
  VertexOperator f = whole.f;
  RingBlock& hole = f.blocks[1];
  hole.views = 0;
  hole.centred.clear();
  hole.view.clear();
  hole.weight.clear();
  hole.seen.clear();
  const VertexTerms result = FactorizeVertex(f, whole.shared, {.terms = 1, .guessed_weight = 1});
  ASSERT_EQ(result.terms.size(), 1u);
  const TermMaps& maps = result.terms[0];
  double inside = 0, elsewhere = 0, hat_inside = 0, hat_elsewhere = 0;
  for (const RingBlock& block : f.blocks) {
    for (int s = 0; s < block.samples; ++s) {
      const double g = DecodeValue(maps.surface_range, maps.surface_codes[block.first_row + s]);
      (block.views == 0 ? inside : elsewhere) += g * block.hat[s];
      (block.views == 0 ? hat_inside : hat_elsewhere) += block.hat[s] * block.hat[s];
    }
  }
  EXPECT_NEAR(inside / hat_inside, elsewhere / hat_elsewhere,
              0.5 * std::abs(elsewhere / hat_elsewhere));
  Ring ring{f, whole.shared, whole.dense};
  ring.dense.middleRows(hole.first_row, hole.samples).setZero();
  Eigen::MatrixXd decoded = Decoded(ring, result.terms, 1);
  decoded.middleRows(hole.first_row, hole.samples).setZero();
  const double error = (ring.dense - decoded).squaredNorm();
  EXPECT_NEAR(result.squared_errors.back(), error, 1e-5 * ring.dense.squaredNorm());
  const double best = ring.dense.squaredNorm() - std::pow(SingularValues(ring.dense)[0], 2);
  EXPECT_LE(error, 1.2 * best);
}

TEST_F(VertexFactorization, NothingToSeeGivesNoTerms) {
  const SyntheticLightField matte = MakeLightField(
      MakeSphere(1), 8, 80, [](int) { return 5; },
      [](const Eigen::Vector3d& p, const Eigen::Vector3d&) -> Eigen::Vector3d {
        return Eigen::Vector3d::Constant(0.5 + 0.004 * p.x());
      });
  const Ring ring = MakeRing(matte, 4);
  const VertexTerms result = FactorizeVertex(ring.f, ring.shared, {.terms = 3});
  EXPECT_TRUE(result.terms.empty());
  EXPECT_EQ(result.squared_errors.size(), 1u);
  EXPECT_TRUE(FactorizeVertex(MakeRing(field_, 4).f, ring.shared, {.terms = 0}).terms.empty());
}

}  // namespace
}  // namespace lfm::testing
