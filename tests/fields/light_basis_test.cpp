// SPDX-License-Identifier: BSD-3-Clause
#include "fields/light_basis.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/error.h"
#include "fields/hemispherical_harmonics.h"
#include "fields/polynomial_texture.h"

namespace lfm {
namespace {

constexpr double kPi = std::numbers::pi;

Eigen::Vector3d Direction(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

// Directions of a spiral over the hemisphere.
std::vector<Eigen::Vector3d> Dome(int count) {
  std::vector<Eigen::Vector3d> directions;
  for (int i = 0; i < count; ++i) {
    directions.push_back(Direction(std::acos(1 - (i + 0.5) / count), 2.4 * i));
  }
  return directions;
}

TEST(HemisphericalHarmonics, AreOrthonormalOverTheHemisphere) {
  // The products are polynomials of cos theta times sqrt(c (1 - c))^n, n even where the integral
  // over phi is not zero: midpoints in phi are exact, a fine rule in c does the rest.
  constexpr int kCosines = 4000, kAngles = 16;
  constexpr double kTolerance_abs = 1e-6;
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(16, 16);
  for (int i = 0; i < kCosines; ++i) {
    const double cosine = (i + 0.5) / kCosines;
    for (int j = 0; j < kAngles; ++j) {
      const Eigen::VectorXd h =
          HemisphericalHarmonics(4, Direction(std::acos(cosine), 2 * kPi * (j + 0.5) / kAngles));
      products += 2 * kPi / (kCosines * kAngles) * h * h.transpose();
    }
  }
  EXPECT_LT((products - Eigen::MatrixXd::Identity(16, 16)).cwiseAbs().maxCoeff(), kTolerance_abs);
}

TEST(HemisphericalHarmonics, AreTheFormulaeOfRtiFiles) {
  for (const Eigen::Vector3d& d : Dome(50)) {
    const double c = d.z(), root = std::sqrt(c - c * c), phi = std::atan2(d.y(), d.x());
    const Eigen::VectorXd h = HemisphericalHarmonics(4, d);
    const double expected[16] = {
        1 / std::sqrt(2 * kPi),
        std::sqrt(6 / kPi) * std::cos(phi) * root,
        std::sqrt(3 / (2 * kPi)) * (2 * c - 1),
        std::sqrt(6 / kPi) * std::sin(phi) * root,
        std::sqrt(30 / kPi) * std::cos(2 * phi) * (c * c - c),
        std::sqrt(30 / kPi) * std::cos(phi) * (2 * c - 1) * root,
        std::sqrt(5 / (2 * kPi)) * (1 - 6 * c + 6 * c * c),
        std::sqrt(30 / kPi) * std::sin(phi) * (2 * c - 1) * root,
        std::sqrt(30 / kPi) * std::sin(2 * phi) * (c * c - c),
        2 * std::sqrt(35 / kPi) * std::cos(3 * phi) * root * root * root,
        std::sqrt(210 / kPi) * std::cos(2 * phi) * (2 * c - 1) * (c * c - c),
        2 * std::sqrt(21 / kPi) * std::cos(phi) * root * (1 - 5 * c + 5 * c * c),
        std::sqrt(7 / (2 * kPi)) * (-1 + 12 * c - 30 * c * c + 20 * c * c * c),
        2 * std::sqrt(21 / kPi) * std::sin(phi) * root * (1 - 5 * c + 5 * c * c),
        std::sqrt(210 / kPi) * std::sin(2 * phi) * (2 * c - 1) * (c * c - c),
        2 * std::sqrt(35 / kPi) * std::sin(3 * phi) * root * root * root};
    for (int i = 0; i < 16; ++i) EXPECT_NEAR(h[i], expected[i], 1e-12) << i;
    EXPECT_EQ(HemisphericalHarmonics(2, d), h.head(4));
    EXPECT_EQ(HemisphericalHarmonics(3, d), h.head(9));
  }
  EXPECT_THROW(HemisphericalHarmonics(5, {0, 0, 1}), Error);
}

TEST(HemisphericalHarmonics, AreFiniteAtPoleAndHorizon) {
  for (const Eigen::Vector3d& d : {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(1, 0, 0),
                                   Eigen::Vector3d(0, 0, 1 + 1e-15), Eigen::Vector3d(0, -1, 0)}) {
    EXPECT_TRUE(HemisphericalHarmonics(4, d).allFinite()) << d.transpose();
  }
}

TEST(LightFrame, BringsLightsBelowTheHorizonOntoIt) {
  const LightFrame frame;
  EXPECT_LT((frame.Local({0.6, 0, -0.8}) - Eigen::Vector3d(1, 0, 0)).norm(), 1e-15);
  EXPECT_EQ(frame.Local({0, 0, -1}), Eigen::Vector3d(1, 0, 0));
  EXPECT_EQ(frame.Local({0, 0, 0}), Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(frame.Local({NAN, 0, 1}), Eigen::Vector3d(0, 0, 1));
  EXPECT_FALSE(frame.IsAbove({0.6, 0, -0.8}));
  EXPECT_TRUE(frame.IsAbove({1, 0, 0}));
}

TEST(LightFrame, OfADomeIsTheWorldUnlessLightsStandBelow) {
  EXPECT_TRUE(DomeFrame(Dome(20)).local_from_world.isIdentity(0));
  std::vector<Eigen::Vector3d> sideways;
  for (const Eigen::Vector3d& d : Dome(20)) sideways.emplace_back(d.z(), d.x(), d.y());
  const LightFrame frame = DomeFrame(sideways);
  EXPECT_GT(frame.Local({1, 0, 0}).z(), 0.98);
  EXPECT_TRUE(
      DomeFrame({{1, 0, 0}, {-1, 0, 0}, {0, 0, 1}, {0, 0, -1}}).local_from_world.isIdentity(0));
}

TEST(LightFrame, OfAViewIsThePictures) {
  const Pose pose = LookAt({0, -500, 0}, {0, 0, 0}, {0, 0, 1});
  const LightFrame frame = ViewFrame(pose);
  EXPECT_LT((frame.Local({0, -1, 0}) - Eigen::Vector3d(0, 0, 1)).norm(), 1e-12);  // to the viewer
  EXPECT_LT((frame.Local({0, 0, 1}) - Eigen::Vector3d(0, 1, 0)).norm(), 1e-12);   // up
  EXPECT_LT((frame.Local({1, 0, 0}) - Eigen::Vector3d(1, 0, 0)).norm(), 1e-12);   // right
  EXPECT_NEAR(frame.local_from_world.determinant(), 1, 1e-12);
}

// The solver applied to what a basis function gives returns that function alone.
TEST(LightSolver, FindsEveryBasisFunctionOnADome) {
  const std::vector<Eigen::Vector3d> lights = Dome(40);
  for (LightBasis basis : {LightBasis::kPolynomial, LightBasis::kHarmonics4,
                           LightBasis::kHarmonics9, LightBasis::kHarmonics16}) {
    const LightSolver solver = MakeLightSolver(basis, {}, lights);
    const int terms = LightBasisTerms(basis);
    EXPECT_EQ(static_cast<int>(solver.used.size()), terms);
    Eigen::MatrixXd values(40, terms);
    for (int i = 0; i < 40; ++i) values.row(i) = LightBasisValues(basis, lights[i]);
    EXPECT_LT((solver.solver * values - Eigen::MatrixXd::Identity(terms, terms)).norm(), 1e-10)
        << LightBasisName(basis);
  }
}

TEST(LightSolver, TakesFewerFunctionsFromFewOrCoplanarLights) {
  const auto used = [](LightBasis basis, const std::vector<Eigen::Vector3d>& lights) {
    return MakeLightSolver(basis, {}, lights).used;
  };
  EXPECT_EQ(used(LightBasis::kPolynomial, {{0, 0.6, 0.8}}), (std::vector<int>{5}));
  EXPECT_EQ(used(LightBasis::kPolynomial, {{0.6, 0, 0.8}, {0, 0.6, 0.8}, {0, 0, 1}}),
            (std::vector<int>{3, 4, 5}));
  // The same light twice says no more than once.
  EXPECT_EQ(used(LightBasis::kPolynomial, {{0, 0.6, 0.8}, {0, 0.6, 0.8}}), (std::vector<int>{5}));
  // Lights in the plane y = 0: 1, lu and lu^2 are all there is.
  std::vector<Eigen::Vector3d> plane;
  for (int i = 0; i < 9; ++i) plane.push_back(Direction(-1.4 + 0.35 * i, 0));
  EXPECT_EQ(used(LightBasis::kPolynomial, plane), (std::vector<int>{0, 3, 5}));
  EXPECT_EQ(used(LightBasis::kHarmonics16, {{0, 0, 1}}), (std::vector<int>{0}));
  EXPECT_LE(used(LightBasis::kHarmonics16, Dome(9)).size(), 9u);
  EXPECT_THROW(used(LightBasis::kHarmonics4, {}), Error);
}

TEST(LightSolver, LeavesLightsBelowTheHorizonOutUnlessThereIsNoOther) {
  const LightSolver mixed =
      MakeLightSolver(LightBasis::kPolynomial, {}, {{0, 0, 1}, {0.6, 0, -0.8}});
  EXPECT_EQ(mixed.solver(5, 0), 1);
  EXPECT_EQ(mixed.solver.col(1).norm(), 0);
  const LightSolver below = MakeLightSolver(LightBasis::kPolynomial, {}, {{0.6, 0, -0.8}});
  EXPECT_NEAR(below.solver(5, 0), 1, 1e-12);
}

}  // namespace
}  // namespace lfm
