// SPDX-License-Identifier: BSD-3-Clause
#include "encode/nonnegative_terms.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "core/error.h"
#include "encode/encode.h"
#include "encode/glb.h"
#include "encode/model_error.h"
#include "encode/model_evaluation.h"
#include "tests/encode/dense_oracle.h"
#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {
namespace {

class NonnegativeTerms : public ::testing::Test {
 protected:
  NonnegativeTerms() {
    const VertexRings rings = ComputeVertexRings(field_.mesh);
    constexpr int kVertex = 4;
    zero_ = [this](int t) {
      return PatchMean(size_t{3} * PatchSampleCount(field_.triangles[t].edge_samples), 0.f);
    };
    f_ = BuildVertexOperator(field_.Source(), kVertex, rings.Ring(kVertex), zero_);
    std::vector<Eigen::Vector3i> triangles;
    std::vector<int> sizes;
    for (const RingBlock& block : f_.blocks) {
      triangles.push_back(field_.mesh.triangles[block.triangle]);
      sizes.push_back(block.edge_samples);
    }
    shared_ = FindSharedSamples(triangles, sizes);
  }
  EncodeResult With(const EncodeOptions& options) const {
    return Encode(field_.Source(), options, SilentProgress());
  }

  SyntheticLightField field_ = MakeLightField(
      MakeSphere(1), 8, 80, [](int t) { return t % 3 == 0 ? 5 : 9; }, GlossyAppearance);
  std::function<PatchMean(int)> zero_;
  VertexOperator f_;
  SharedSamples shared_;
};

TEST_F(NonnegativeTerms, MapsAreNonnegativeAndErrAsReported) {
  const Eigen::MatrixXd dense = DenseMatrix(field_, f_, zero_);
  for (const PcaSolver solver : {PcaSolver::kFactored, PcaSolver::kPaper}) {
    const VertexTerms result =
        FactorizeNonnegative(f_, shared_, 7.0, {.terms = 3, .solver = solver});
    ASSERT_EQ(result.terms.size(), 3U);
    EXPECT_EQ(result.squared_errors.front(), 7.0);
    Eigen::MatrixXd left = dense;
    for (const TermMaps& maps : result.terms) {
      Eigen::VectorXd u(f_.rows), v(f_.cols());
      for (int row = 0; row < f_.rows; ++row) {
        u[row] = DecodeValue(maps.surface_range, maps.surface_codes[row]);
      }
      for (int col = 0; col < f_.cols(); ++col) {
        v[col] = DecodeValue(maps.view_range,
                             maps.view_codes[3 * (col % f_.directions) + col / f_.directions]);
      }
      EXPECT_GE(u.minCoeff(), 0);
      EXPECT_GE(v.minCoeff(), 0);
      left -= u * v.transpose();
    }
    EXPECT_NEAR(result.squared_errors.back(), left.squaredNorm(), 1e-4 * dense.squaredNorm());
    EXPECT_LT(left.norm(), 0.1 * dense.norm()) << static_cast<int>(solver);
  }
}

TEST_F(NonnegativeTerms, AreNearlyAsGoodAsPcaAndFarBetterThanTheMeanView) {
  const EncodeResult pca = With({.terms = 4});
  const EncodeResult nmf = With({.factorization = Factorization::kNmf, .terms = 5});
  EXPECT_TRUE(nmf.model.mean_in_terms);
  EXPECT_NEAR(nmf.matrix_psnr_mean_only_db, pca.matrix_psnr_mean_only_db, 0.01);
  EXPECT_GT(nmf.matrix_psnr_db, nmf.matrix_psnr_mean_only_db + 5);
  EXPECT_LT(nmf.matrix_psnr_db, pca.matrix_psnr_db + 1);
  EXPECT_GT(nmf.matrix_psnr_db, pca.matrix_psnr_db - 4);
  // The mean view is the same texture for viewers that know no more.
  const Eigen::Vector3f color = EvaluateModel(nmf.model, 3, {0.2, 0.3, 0.5}, {0, 0, 1}, {0});
  EXPECT_LE((color - EvaluateModel(pca.model, 3, {0.2, 0.3, 0.5}, {0, 0, 1}, {0})).norm(), 1e-6);
}

// Bright and nearly dull: what rounding costs is all that is left.
Eigen::Vector3d NearlyDull(const Eigen::Vector3d& p, const Eigen::Vector3d& to_eye) {
  const double gloss = 0.03 * to_eye.z() * std::sin(0.08 * p.x());
  return Eigen::Vector3d::Constant(0.6 + 0.2 * std::sin(0.05 * p.x() + 0.06 * p.y()) + gloss);
}

TEST(NonnegativeRounding, DoesNotAddUpOverTheTerms) {
  const SyntheticLightField field = MakeLightField(
      MakeSphere(1), 8, 80, [](int) { return 7; }, NearlyDull);
  double fewest = 0;
  for (const int terms : {2, 4, 6, 8}) {
    const double psnr =
        Encode(field.Source(), {.factorization = Factorization::kNmf, .terms = terms},
               SilentProgress())
            .matrix_psnr_db;
    if (terms == 2) fewest = psnr;
    EXPECT_GT(psnr, fewest - 0.1) << terms;
  }
}

TEST_F(NonnegativeTerms, ComeBackFromBothForms) {
  const EncodeResult nmf = With({.factorization = Factorization::kNmf, .terms = 3});
  const std::string file = ::testing::TempDir() + "lfm_nonnegative.glb";
  WriteGlb(nmf.model, file);
  const LightFieldModel glb = ReadGlb(file);
  std::remove(file.c_str());
  const LightFieldModel lfz = ReorderModel(DecodeTransport(nmf.transport.bytes, "model.lfz").model,
                                           Inverse(nmf.transport.order));
  ASSERT_TRUE(glb.mean_in_terms && lfz.mean_in_terms);
  // Cut off, it shows the mean view rather than part of the light.
  const LightFieldModel cut =
      DecodeTransport(nmf.transport.bytes.substr(0, nmf.transport.bytes.size() - 1), "model.lfz")
          .model;
  EXPECT_EQ(cut.terms, 0);
  for (int t = 0; t < static_cast<int>(glb.placements.size()); t += 3) {
    const Eigen::Vector3d to_eye = TriangleNormal(glb.mesh, t);
    const Eigen::Vector3f shown = EvaluateModel(nmf.model, t, {0.3, 0.3, 0.4}, to_eye);
    EXPECT_LE((EvaluateModel(glb, t, {0.3, 0.3, 0.4}, to_eye) - shown).norm(), 1e-5);
    EXPECT_LE((EvaluateModel(lfz, t, {0.3, 0.3, 0.4}, to_eye) - shown).norm(), 0.03);
  }
}

TEST_F(NonnegativeTerms, VerticesWithoutTermsShowTheMeanView) {
  EncodeResult nmf = With({.factorization = Factorization::kNmf, .terms = 2});
  LightFieldModel& model = nmf.model;
  const Eigen::Vector3d to_eye = TriangleNormal(model.mesh, 0);
  const Eigen::Vector3f mean = EvaluateModel(model, 0, {1, 0, 0}, to_eye, {0});
  const Eigen::Vector3d middle(0.5, 0.25, 0.25);
  const Eigen::Vector3f middle_mean = EvaluateModel(model, 0, middle, to_eye, {0});
  const Eigen::Vector3i& corners = model.mesh.triangles[0];
  model.vertex_terms[corners[0]] = 0;
  EXPECT_LE((EvaluateModel(model, 0, {1, 0, 0}, to_eye) - mean).norm(), 1e-6);
  // Away from that corner its share falls off linearly; the others' terms are as they were.
  const Eigen::Vector3f shown = EvaluateModel(model, 0, middle, to_eye);
  for (const int corner : {corners[1], corners[2]}) model.vertex_terms[corner] = 0;
  EXPECT_LE((EvaluateModel(model, 0, middle, to_eye) - middle_mean).norm(), 1e-6);
  model.mean_in_terms = false;
  for (const int corner : {corners[1], corners[2]}) model.vertex_terms[corner] = 2;
  const Eigen::Vector3f with_whole_mean = EvaluateModel(model, 0, middle, to_eye);
  EXPECT_LE((with_whole_mean - middle_mean * 0.5f - shown).norm(), 1e-5);
}

TEST_F(NonnegativeTerms, HoldAtTheExtremes) {
  const auto of = [](double level) {
    const SyntheticLightField field = MakeLightField(
        MakeSphere(1), 6, 60, [](int) { return 4; },
        [level](const Eigen::Vector3d&, const Eigen::Vector3d&) {
          return Eigen::Vector3d(Eigen::Vector3d::Constant(level));
        });
    return Encode(field.Source(), {.factorization = Factorization::kNmf, .terms = 3},
                  SilentProgress())
        .model;
  };
  EXPECT_EQ(EvaluateModel(of(0), 0, {0.3, 0.3, 0.4}, {0, 0, 1}), Eigen::Vector3f::Zero());
  const Eigen::Vector3f white = EvaluateModel(of(1), 0, {0.3, 0.3, 0.4}, {0, 0, 1});
  EXPECT_LE((white - Eigen::Vector3f::Ones()).cwiseAbs().maxCoeff(), 3.0 / 255);
  EXPECT_EQ(With({.factorization = Factorization::kNmf, .terms = 0}).model.terms, 0);
}

TEST_F(NonnegativeTerms, RefuseWhatTheyCannotDo) {
  EXPECT_THROW(With({.factorization = Factorization::kNmf, .target_db = 40}), Error);
  EXPECT_THROW(With({.factorization = Factorization::kNmf, .solver = PcaSolver::kDense}), Error);
}

TEST_F(NonnegativeTerms, ErrorAgainstTheLightFieldIsWhatEncodeReports) {
  for (const Factorization factorization : {Factorization::kPca, Factorization::kNmf}) {
    const EncodeResult result = With({.factorization = factorization, .terms = 3});
    EXPECT_NEAR(CompareWithLightField(field_.Source(), result.model).psnr_db(),
                result.matrix_psnr_db, 0.01);
    const EncodedTransport encoded = EncodeTransport(result.model, {36});
    const double coarse =
        CompareWithLightField(
            field_.Source(),
            ReorderModel(DecodeTransport(encoded.bytes, "model").model, Inverse(encoded.order)))
            .psnr_db();
    EXPECT_LT(coarse, result.matrix_psnr_db);
    EXPECT_GT(coarse, 30);
  }
  const EncodeResult other =
      Encode(MakeLightField(
                 MakeSphere(1), 8, 80, [](int) { return 6; }, GlossyAppearance)
                 .Source(),
             {.terms = 2}, SilentProgress());
  EXPECT_THROW(CompareWithLightField(field_.Source(), other.model), Error);
}

}  // namespace
}  // namespace lfm::testing
