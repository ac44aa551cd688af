// SPDX-License-Identifier: BSD-3-Clause
#include "core/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "test_files.h"

namespace lfm {
namespace {

Camera Pinhole() {
  Camera camera;
  camera.width = 960;
  camera.height = 720;
  camera.fx = 1210;
  camera.fy = 1195;
  camera.cx = 484.2;
  camera.cy = 355.1;
  return camera;
}

Camera Lens(double k1, double k2, double k3, double p1, double p2) {
  Camera camera = Pinhole();
  camera.k1 = k1;
  camera.k2 = k2;
  camera.k3 = k3;
  camera.p1 = p1;
  camera.p2 = p2;
  return camera;
}

// The centre of the top-left pixel is (0, 0), so the sensor begins half a
// pixel before it.
TEST(Camera, SensorBeginsHalfAPixelBeforeTheFirstCentre) {
  const Camera camera = Pinhole();
  EXPECT_TRUE(camera.Contains({-0.5, -0.5}));
  EXPECT_TRUE(camera.Contains({959.499, 719.499}));
  EXPECT_FALSE(camera.Contains({-0.501, 0}));
  EXPECT_FALSE(camera.Contains({0, -0.501}));
  EXPECT_FALSE(camera.Contains({959.5, 0}));
  EXPECT_FALSE(camera.Contains({0, 719.5}));
  EXPECT_FALSE(camera.Contains({std::nan(""), 0}));
}

// x right, y down, z forward: a point right of and below the axis has larger u and v.
TEST(Camera, HasOpenCvAxes) {
  const Camera camera = Pinhole();
  const auto axis = Project(camera, {0, 0, 500});
  ASSERT_TRUE(axis);
  EXPECT_EQ(*axis, Eigen::Vector2d(camera.cx, camera.cy));
  const auto pixel = Project(camera, {50, 20, 500});
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x(), camera.cx + 1210 * 0.1, 1e-10);
  EXPECT_NEAR(pixel->y(), camera.cy + 1195 * 0.04, 1e-10);
}

TEST(Camera, DistortionIsBrownsFormula) {
  const Camera c = Lens(-0.21, 0.12, -0.03, 0.0011, -0.0007);
  for (const double x : {-0.4, 0.0, 0.3}) {
    for (const double y : {-0.3, 0.1, 0.25}) {
      const double r2 = x * x + y * y;
      const double radial = 1 + c.k1 * r2 + c.k2 * r2 * r2 + c.k3 * r2 * r2 * r2;
      const Eigen::Vector2d expected(x * radial + 2 * c.p1 * x * y + c.p2 * (r2 + 2 * x * x),
                                     y * radial + c.p1 * (r2 + 2 * y * y) + 2 * c.p2 * x * y);
      EXPECT_LT((Distort(c, {x, y}) - expected).norm(), 1e-15);
      const auto pixel = Project(c, {2 * x, 2 * y, 2});
      ASSERT_TRUE(pixel);
      EXPECT_NEAR(pixel->x(), c.fx * expected.x() + c.cx, 1e-10);
      EXPECT_NEAR(pixel->y(), c.fy * expected.y() + c.cy, 1e-10);
    }
  }
}

Camera RationalLens() {
  Camera camera = Lens(0.6, 0.1, -0.02, 1e-3, -5e-4);
  camera.k4 = 0.85, camera.k5 = 0.2, camera.k6 = 0.03;
  return camera;
}

TEST(Camera, RationalFactorDividesTwoPolynomials) {
  const Camera c = RationalLens();
  const double x = 0.3, y = -0.2, r2 = x * x + y * y;
  const double s = (1 + c.k1 * r2 + c.k2 * r2 * r2 + c.k3 * r2 * r2 * r2) /
                   (1 + c.k4 * r2 + c.k5 * r2 * r2 + c.k6 * r2 * r2 * r2);
  const Eigen::Vector2d expected(x * s + 2 * c.p1 * x * y + c.p2 * (r2 + 2 * x * x),
                                 y * s + c.p1 * (r2 + 2 * y * y) + 2 * c.p2 * x * y);
  EXPECT_LT((Distort(c, {x, y}) - expected).norm(), 1e-15);
  Camera folds = Pinhole();
  folds.k4 = -4;  // a pole at half the focal length
  EXPECT_TRUE(Project(folds, {0.3, 0, 1}));
  EXPECT_FALSE(Project(folds, {0.51, 0, 1}));
  EXPECT_FALSE(Project(folds, {3, 0, 1}));
}

TEST(Camera, ProjectInvertsUnproject) {
  constexpr double kRoundTrip_px_abs = 1e-9;
  const Camera lenses[] = {Pinhole(),
                           Lens(-0.25, 0.1, 0, 1e-3, -5e-4),
                           Lens(0.2, -0.05, 0.02, -2e-3, 1e-3),
                           Lens(-0.35, 0.2, -0.05, 0, 0),
                           Lens(0, 0, 0, 4e-3, -4e-3),
                           RationalLens()};
  for (const Camera& lens : lenses) {
    for (double y = -0.5; y <= 719.5; y += 36) {
      for (double x = -0.5; x <= 959.5; x += 48) {
        const Eigen::Vector3d direction = Unproject(lens, {x, y});
        EXPECT_NEAR(direction.norm(), 1, 1e-14);
        for (const double distance : {0.01, 700.0, 1e7}) {
          const auto pixel = Project(lens, distance * direction);
          ASSERT_TRUE(pixel);
          EXPECT_LT((*pixel - Eigen::Vector2d(x, y)).norm(), kRoundTrip_px_abs);
        }
      }
    }
  }
}

// Pixels a little inside and outside the fold at 2/3: an answer, where there is one, is as near as
// anywhere else.
TEST(Camera, RoundTripHoldsBesideAFold) {
  constexpr double kRoundTrip_px_abs = 1e-9;
  const Camera lens = Lens(-1.0 / 3, 0, 0, 0, 0);
  int answers = 0, refusals = 0;
  for (int turn = 0; turn < 40; ++turn) {
    const Eigen::Vector2d out(std::cos(0.16 * turn), std::sin(0.16 * turn));
    for (double off_px = 1e-10; off_px < 1e-2; off_px *= 1.7) {
      for (const double side : {-1.0, 1.0}) {
        const Eigen::Vector2d distorted = (2.0 / 3 + side * off_px / lens.fx) * out;
        const Eigen::Vector2d pixel(lens.fx * distorted.x() + lens.cx,
                                    lens.fy * distorted.y() + lens.cy);
        const auto direction = TryUnproject(lens, pixel);
        if (!direction) {
          ++refusals;
          continue;
        }
        ++answers;
        const auto back = Project(lens, *direction);
        if (!back) continue;  // at the fold itself, rounding decides on which side it lies
        EXPECT_LT((*back - pixel).norm(), kRoundTrip_px_abs) << off_px * side;
      }
    }
  }
  EXPECT_GT(answers, 100);
  EXPECT_GT(refusals, 100);
}

// The largest sensor, at focal lengths from a fisheye's to a telescope's, and pixels that are not
// square.
TEST(Camera, RoundTripHoldsOnTheLargestSensor) {
  constexpr double kRoundTrip_px_abs = 1e-9;
  Camera lens = Lens(-0.02, 0.004, 0, 1e-3, -5e-4);
  lens.width = lens.height = 65536;
  lens.cx = lens.cy = 32767.5;
  for (const double fx : {3e4, 1e6}) {
    lens.fx = fx;
    lens.fy = 5 * fx;
    for (double y = -0.5; y < 65536; y += 8191) {
      for (double x = -0.5; x < 65536; x += 8191) {
        const auto pixel = Project(lens, Unproject(lens, {x, y}));
        ASSERT_TRUE(pixel);
        EXPECT_LT((*pixel - Eigen::Vector2d(x, y)).norm(), kRoundTrip_px_abs);
      }
    }
  }
}

TEST(Camera, PointsNotInFrontHaveNoPixel) {
  const Camera camera = Pinhole();
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(Project(camera, {0, 0, 0}));
  EXPECT_FALSE(Project(camera, {1, 1, -100}));
  EXPECT_FALSE(Project(camera, {nan, 0, 100}));
  EXPECT_FALSE(Project(camera, {0, infinity, 100}));
  EXPECT_FALSE(Project(camera, {0, 0, infinity}));
  EXPECT_FALSE(Project(camera, {1e300, 0, 1e-300}));
}

// r (1 + k1 r^2) with k1 = -1/3 rises up to r = 1 and falls beyond: a point at r = 1.2 would land
// on the pixel of one at r < 1.
TEST(Camera, LensThatFoldsBackShowsNothingBeyondTheFold) {
  const Camera folded = Lens(-1.0 / 3, 0, 0, 0, 0);
  EXPECT_TRUE(Project(folded, {0.99, 0, 1}));
  EXPECT_FALSE(Project(folded, {1.01, 0, 1}));
  EXPECT_FALSE(Project(folded, {-5, 0, 1}));
  // Beyond the largest distorted radius, 2/3, no direction exists.
  EXPECT_FALSE(TryUnproject(folded, {folded.cx + 0.7 * folded.fx, folded.cy}));
  ExpectError([&] { Unproject(folded, {folded.cx + 0.7 * folded.fx, folded.cy}); }, "folds");
  const Eigen::Vector3d edge = Unproject(folded, {folded.cx + 0.6 * folded.fx, folded.cy});
  EXPECT_LT(edge.x() / edge.z(), 1);
}

// With k1 < 0 and k2 > 0 the polynomial may fall and rise again: both parts past the first fold
// are not in the picture.
TEST(Camera, FoldBetweenTheAxisAndThePointCounts) {
  const Camera lens = Lens(-1.0, 0.35, 0, 0, 0);
  EXPECT_TRUE(Project(lens, {0.5, 0, 1}));
  EXPECT_FALSE(Project(lens, {2, 0, 1}));
}

TEST(Camera, UnprojectRefusesPixelsThatAreNotFinite) {
  ExpectError([] { Unproject(Pinhole(), {std::nan(""), 0}); }, "camera");
  ExpectError([] { Unproject(Lens(-0.1, 0, 0, 0, 0), {std::nan(""), 0}); }, "camera");
}

// The whole sensor stays the whole sensor: its corners are at -0.5 and size - 0.5 in both.
TEST(Camera, ScalingKeepsThePicture) {
  const Camera camera = Lens(-0.2, 0.1, 0, 1e-3, 1e-3);
  for (const double factor : {0.5, 2.0, 1.25}) {
    const Camera scaled = ScaleCamera(camera, factor);
    EXPECT_EQ(scaled.width, 960 * factor);
    const Eigen::Vector3d point(40, -30, 300);
    const Eigen::Vector2d before = *Project(camera, point), after = *Project(scaled, point);
    EXPECT_LT(((before.array() + 0.5) * factor - 0.5 - after.array()).matrix().norm(), 1e-10);
  }
}

TEST(Camera, ValidationNamesThePlace) {
  EXPECT_NO_THROW(ValidateCamera(Pinhole(), "photo 3"));
  Camera camera = Pinhole();
  camera.fx = 0;
  ExpectError([&] { ValidateCamera(camera, "photo 3"); }, "photo 3");
  camera = Pinhole();
  camera.k2 = std::nan("");
  ExpectError([&] { ValidateCamera(camera, "x"); }, "finite");
  camera = Pinhole();
  camera.width = 65537;
  ExpectError([&] { ValidateCamera(camera, "x"); }, "65536");
}

}  // namespace
}  // namespace lfm
