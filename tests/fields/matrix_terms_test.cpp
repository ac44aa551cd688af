// SPDX-License-Identifier: BSD-3-Clause
#include "fields/matrix_terms.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>
#include <random>

#include "core/error.h"
#include "core/parallel.h"
#include "fields/matrix_products.h"

namespace lfm {
namespace {

Eigen::MatrixXd RandomMatrix(int rows, int columns, uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
}

Eigen::MatrixXd RandomOrthonormal(int rows, int columns, uint32_t seed) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(RandomMatrix(rows, columns, seed));
  return qr.householderQ() * Eigen::MatrixXd::Identity(rows, columns);
}

FunctionRows Rows(const Eigen::MatrixXd& m, double scale = 1) {
  FunctionRows rows = MakeFunctionRows(m.rows(), static_cast<int>(m.cols()));
  for (int64_t i = 0; i < m.rows(); ++i) {
    for (int64_t j = 0; j < m.cols(); ++j) rows.Row(i)[j] = static_cast<float>(scale * m(i, j));
  }
  return rows;
}

Eigen::MatrixXd Dense(RowsView rows) {
  Eigen::MatrixXd m(rows.rows, rows.columns);
  for (int64_t i = 0; i < rows.rows; ++i) {
    for (int j = 0; j < rows.columns; ++j) m(i, j) = rows.Row(i)[j];
  }
  return m;
}

// Singular values fall by `ratio` from term to term.
FunctionRows Decaying(int rows, int columns, double ratio, uint32_t seed, double scale = 1) {
  const int terms = std::min(rows, columns);
  Eigen::VectorXd values(terms);
  for (int k = 0; k < terms; ++k) values(k) = std::pow(ratio, k);
  return Rows(RandomOrthonormal(rows, terms, seed) * values.asDiagonal() *
                  RandomOrthonormal(columns, terms, seed + 1).transpose(),
              scale);
}

// What is left of `a` once the functions' part is taken off, of its energy.
double MissingShare(const FunctionRows& a, const MatrixTerms& terms) {
  const Eigen::MatrixXd m = Dense(a.View()), v = Dense(terms.functions.View());
  return (m - m * v.transpose() * v).squaredNorm() / m.squaredNorm();
}

double MostOfUnorthogonality(const MatrixTerms& terms) {
  const Eigen::MatrixXd gram = GramOfRows(terms.functions.View());
  return (gram - Eigen::MatrixXd::Identity(gram.rows(), gram.cols())).cwiseAbs().maxCoeff();
}

constexpr double kOrthonormal_abs = 1e-5;

TEST(MatrixTerms, AreTheSingularVectors) {
  for (const auto& [rows, columns] : {std::pair{90, 60}, {60, 90}, {1, 40}, {40, 1}}) {
    for (const TermsMethod method : {TermsMethod::kExact, TermsMethod::kSubspace}) {
      const FunctionRows a = Decaying(rows, columns, 0.8, 11);
      const Eigen::JacobiSVD<Eigen::MatrixXd> svd(Dense(a.View()),
                                                  Eigen::ComputeThinU | Eigen::ComputeThinV);
      const MatrixTerms terms = TermsOf(a.View(), {.max_terms = 6, .method = method});
      ASSERT_EQ(terms.functions.rows, std::min({6, rows, columns}));
      for (int k = 0; k < terms.functions.rows; ++k) {
        const double value = svd.singularValues()(k);
        EXPECT_NEAR(std::sqrt(terms.energies[k]), value, 1e-5 * svd.singularValues()(0));
        const double same =
            Dense(terms.functions.View()).row(k).dot(svd.matrixV().col(k).transpose());
        EXPECT_NEAR(std::abs(same), 1, 1e-5);
      }
      EXPECT_LT(MostOfUnorthogonality(terms), kOrthonormal_abs);
    }
  }
}

TEST(MatrixTerms, HoldAShareWithAsFewAsThereCanBe) {
  const FunctionRows a = Decaying(450, 420, 0.95, 12);
  const std::vector<double> spectrum = EnergySpectrum(a.View());
  for (const double share : {0.5, 0.99, 0.999, 0.9995}) {
    const int needed = TermsHolding(spectrum, EnergyOf(a.View()), share);
    // sum_{k<n} r^2k = (1 - r^2n) / (1 - r^2)
    EXPECT_EQ(needed, std::ceil(std::log(1 - share) / std::log(0.95 * 0.95)));
    for (const TermsMethod method :
         {TermsMethod::kExact, TermsMethod::kSubspace, TermsMethod::kAutomatic}) {
      const MatrixTerms terms = TermsOf(a.View(), {.energy_share = share, .method = method});
      EXPECT_EQ(terms.functions.rows, needed);
      EXPECT_LE(MissingShare(a, terms), 1 - share + 1e-6);
      EXPECT_NEAR(terms.CapturedEnergy() / terms.energy, 1 - MissingShare(a, terms), 1e-5);
      const MatrixTerms energies =
          TermEnergiesOf(a.View(), {.energy_share = share, .method = method});
      EXPECT_EQ(static_cast<int>(energies.energies.size()), needed);
    }
  }
}

// Flat spectra converge slowest: what the subspace catches stays within a few percent of what is
// missing, and the check says what it is.
TEST(MatrixTerms, SayWhatTheyCaughtOfNoise) {
  const FunctionRows a = Rows(RandomMatrix(700, 600, 13));
  const MatrixTerms exact = TermsOf(a.View(), {.max_terms = 50, .method = TermsMethod::kExact});
  const MatrixTerms found = TermsOf(a.View(), {.max_terms = 50, .method = TermsMethod::kSubspace});
  ASSERT_EQ(found.functions.rows, 50);
  EXPECT_LE(found.CapturedEnergy(), exact.CapturedEnergy() * (1 + 1e-6));
  EXPECT_GT(found.CapturedEnergy(), exact.CapturedEnergy() * 0.97);
  const double missing = 1 - found.CapturedEnergy() / found.energy;
  EXPECT_LE(MissingShare(a, found), missing + 1e-6);
  EXPECT_NEAR(MissingShare(a, found), missing, 1e-3);
}

TEST(MatrixTerms, StopAtTheRank) {
  const FunctionRows a = Rows(RandomMatrix(800, 3, 14) * RandomMatrix(3, 700, 15));
  for (const TermsMethod method : {TermsMethod::kExact, TermsMethod::kSubspace}) {
    const MatrixTerms terms = TermsOf(a.View(), {.max_terms = 40, .method = method});
    EXPECT_EQ(terms.functions.rows, 3);
    EXPECT_LT(MissingShare(a, terms), 1e-10);
    EXPECT_LT(MostOfUnorthogonality(terms), kOrthonormal_abs);
  }
}

TEST(MatrixTerms, OfConstantAndBlackMatrices) {
  const FunctionRows constant = Rows(Eigen::MatrixXd::Constant(500, 450, 3.5));
  const FunctionRows black = MakeFunctionRows(500, 450), none = MakeFunctionRows(0, 7);
  for (const TermsMethod method :
       {TermsMethod::kExact, TermsMethod::kSubspace, TermsMethod::kAutomatic}) {
    const MatrixTerms one = TermsOf(constant.View(), {.method = method});
    ASSERT_EQ(one.functions.rows, 1);
    EXPECT_NEAR(one.energies[0] / (500 * 450 * 3.5 * 3.5), 1, 3e-6);
    for (const FunctionRows* nothing : {&black, &none}) {
      const MatrixTerms terms = TermsOf(nothing->View(), {.method = method});
      EXPECT_EQ(terms.functions.rows, 0);
      EXPECT_EQ(terms.functions.columns, nothing->columns);
      EXPECT_EQ(terms.energy, 0);
    }
  }
  EXPECT_EQ(TermsHolding({}, 0, 0.9), 0);
}

TEST(MatrixTerms, HoldExtremeMagnitudes) {
  for (const double scale : {1e-25, 1e25}) {
    const FunctionRows a = Decaying(450, 420, 0.7, 16, scale);
    for (const TermsMethod method : {TermsMethod::kExact, TermsMethod::kSubspace}) {
      const MatrixTerms terms = TermsOf(a.View(), {.energy_share = 0.9999, .method = method});
      EXPECT_EQ(terms.functions.rows, 13);  // 0.49^13 < 1e-4 < 0.49^12
      EXPECT_LT(MissingShare(a, terms), 1e-4);
      EXPECT_NEAR(terms.energies[0] / (scale * scale), 1, 1e-5);
    }
  }
}

TEST(MatrixTerms, TakeTheMeanOffWhenAsked) {
  Eigen::MatrixXd m = RandomMatrix(50, 2, 17) * RandomMatrix(2, 30, 18);
  m.rowwise() += Eigen::RowVectorXd::Constant(30, 100.0);
  const MatrixTerms terms = TermsOf(Rows(m).View(), {.centring = Centring::kMean});
  const Eigen::MatrixXd centred = m.rowwise() - m.colwise().mean();
  EXPECT_NEAR(terms.energy / centred.squaredNorm(), 1, 1e-4);
  for (int j = 0; j < 30; ++j) EXPECT_NEAR(terms.mean[j], m.col(j).mean(), 1e-4);
  EXPECT_NEAR(terms.energies[0] + terms.energies[1], centred.squaredNorm(), 1e-3);
}

TEST(MatrixTerms, GiveCoefficientsThatRebuildTheRows) {
  const FunctionRows a = Decaying(40, 70, 0.5, 19);
  const MatrixTerms terms = TermsOf(a.View(), {.max_terms = 20});
  const std::vector<float> weights = CoefficientsOf(a.View(), terms.functions.View());
  for (int64_t row = 0; row < a.rows; ++row) {
    for (int j = 0; j < a.columns; ++j) {
      double value = 0;
      for (int64_t k = 0; k < terms.functions.rows; ++k) {
        value += weights[row * terms.functions.rows + k] * terms.functions.Row(k)[j];
      }
      EXPECT_NEAR(value, a.Row(row)[j], 1e-5);
    }
  }
}

TEST(MatrixTerms, DoNotDependOnTheNumberOfThreads) {
  const FunctionRows a = Decaying(600, 700, 0.97, 20);
  for (const TermsMethod method : {TermsMethod::kExact, TermsMethod::kSubspace}) {
    const TermsOptions options = {.energy_share = 0.99, .method = method};
    SetThreadCount(1);
    const MatrixTerms one = TermsOf(a.View(), options);
    SetThreadCount(3);
    const MatrixTerms three = TermsOf(a.View(), options);
    SetThreadCount(0);
    EXPECT_EQ(one.functions.values, three.functions.values);
    EXPECT_EQ(one.energies, three.energies);
  }
}

TEST(MatrixTerms, RejectWhatIsNotFinite) {
  FunctionRows a = Decaying(5, 6, 0.5, 21);
  EXPECT_THROW(TermsOf(a.View(), {.max_terms = -1}), Error);
  EXPECT_THROW(TermsOf(a.View(), {.energy_share = std::nan("")}), Error);
  EXPECT_THROW(TermsOf(a.View(), {.energy_share = 1.5}), Error);
  for (const float bad : {NAN, INFINITY, -INFINITY}) {
    a.Row(3)[2] = bad;
    EXPECT_THROW(TermsOf(a.View(), {}), Error);
    EXPECT_THROW(EnergySpectrum(a.View()), Error);
  }
}

}  // namespace
}  // namespace lfm
