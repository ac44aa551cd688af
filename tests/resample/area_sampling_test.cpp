// SPDX-License-Identifier: BSD-3-Clause
#include "resample/area_sampling.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "resample/light_field.h"

namespace lfm {
namespace {

constexpr int kWidth = 120, kHeight = 100;

Camera PlainCamera() {
  Camera camera;
  camera.width = kWidth;
  camera.height = kHeight;
  camera.fx = camera.fy = 100;
  camera.cx = (kWidth - 1) / 2.0;
  camera.cy = (kHeight - 1) / 2.0;
  return camera;
}

using GrayAt = double (*)(int x, int y);

PhotoPixels Gray(GrayAt level) {
  Image picture(kWidth, kHeight, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      for (int c = 0; c < 3; ++c) {
        picture.At<uint8_t>(x, y, c) = static_cast<uint8_t>(std::lround(level(x, y)));
      }
    }
  }
  return MakePhotoPixels(picture, std::vector<PixelUse>(size_t{kWidth} * kHeight, PixelUse::kData),
                         PlainCamera(), "photo.png");
}

void SetUse(PhotoPixels& photo, int x, PixelUse use) {
  for (int y = 0; y < kHeight; ++y) {
    photo.rgbu[4 * (static_cast<size_t>(y) * kWidth + x) + 3] = static_cast<uint8_t>(use);
  }
}

/// A patch that lies across the view, its samples `a` and `b` pixels apart.
std::vector<Eigen::Vector3d> PatchAt(const Eigen::Vector2d& corner, const Eigen::Vector2d& a,
                                     const Eigen::Vector2d& b, int n) {
  std::vector<Eigen::Vector3d> points;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i + j < n; ++i) {
      points.push_back(300 * Unproject(PlainCamera(), corner + i * a + j * b));
    }
  }
  return points;
}

double Level(const SampledView& view, size_t sample) {
  return double(view.values[3 * sample]) / LightField::kOne * 255;
}

double Spread(const SampledView& view) {
  double sum = 0, squares = 0;
  const auto count = static_cast<double>(view.values.size());
  for (const uint16_t value : view.values) {
    sum += value;
    squares += double(value) * value;
  }
  return std::sqrt(squares / count - sum * sum / count / count) / LightField::kOne * 255;
}

TEST(FootprintTaps, HaveTheCovarianceOfTheSamplesHatFunction) {
  for (const auto& [a, b] : {std::pair<Eigen::Vector2d, Eigen::Vector2d>{{4, 0}, {2, 3.5}},
                             {{9, 1}, {1, 2.5}},
                             {{3, 0}, {0, 0.2}},
                             {{20, 5}, {-8, 14}}}) {
    const auto taps = FootprintTaps(a, b);
    Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity() / 6;  // of a bilinear reading
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    double sum = 0;
    for (const FootprintTap& tap : taps) {
      EXPECT_GT(tap.weight, 0);
      sum += tap.weight;
      mean += tap.weight * tap.offset_px;
      covariance += tap.weight * tap.offset_px * tap.offset_px.transpose();
    }
    EXPECT_NEAR(sum, 1, 1e-5);
    EXPECT_LT(mean.norm(), 1e-4);
    // The mean over the triangle's support of the function that is 1 at the sample and 0 at its
    // six neighbours, by brute force.
    Eigen::Matrix2d hat = Eigen::Matrix2d::Zero();
    double volume = 0;
    for (double u = -1; u <= 1; u += 0.02) {
      for (double v = -1; v <= 1; v += 0.02) {
        const double height = 1 - std::max({std::abs(u), std::abs(v), std::abs(u + v)});
        if (height <= 0) continue;
        hat += height * (u * a + v * b) * (u * a + v * b).transpose();
        volume += height;
      }
    }
    hat /= volume;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(hat);
    for (int k = 0; k < 2; ++k) {
      const Eigen::Vector2d axis = axes.eigenvectors().col(k);
      const double expected = std::max(axes.eigenvalues()[k], 1.0 / 6);
      // The Gaussian ends at 2.5 standard deviations.
      EXPECT_NEAR(axis.dot(covariance * axis) / expected, 1, 0.12) << a.transpose();
    }
  }
}

TEST(FootprintTaps, AreOneWhereSamplesLieCloserThanPixelsAndBoundedWhereFarApart) {
  EXPECT_EQ(FootprintTaps({0.9, 0.1}, {0.2, 0.8}).size(), 1u);
  EXPECT_EQ(FootprintTaps({0, 0}, {0, 0}).size(), 1u);
  EXPECT_EQ(FootprintTaps({1e6, 0}, {0, 1e6}).size(), 65u * 65u);
}

TEST(SampleViewByArea, IsBilinearWhereMagnified) {
  const PhotoPixels photo = Gray([](int x, int y) { return 127 + 60 * std::sin(x) * std::cos(y); });
  const auto points = PatchAt({31.3, 40.2}, {0.7, 0.1}, {0.2, 0.8}, 13);
  const SampledView bilinear = SampleView(photo, PlainCamera(), Pose{}, points);
  const SampledView area = SampleViewByArea(photo, PlainCamera(), Pose{}, points, 13);
  EXPECT_EQ(area.values, bilinear.values);
  EXPECT_EQ(area.knowledge, bilinear.knowledge);
  EXPECT_EQ(area.data_samples, bilinear.data_samples);
}

TEST(SampleViewByArea, KeepsConstantsAndRamps) {
  const auto points = PatchAt({30, 30}, {6, 1}, {2, 5}, 7);
  const PhotoPixels constant = Gray([](int, int) { return 93.0; });
  const SampledView flat = SampleViewByArea(constant, PlainCamera(), Pose{}, points, 7);
  const PhotoPixels ramp = Gray([](int x, int) { return 2.0 * x; });
  const SampledView slope = SampleViewByArea(ramp, PlainCamera(), Pose{}, points, 7);
  EXPECT_EQ(flat.data_samples, 28);
  for (size_t s = 0; s < points.size(); ++s) {
    EXPECT_NEAR(Level(flat, s), 93, 0.01);
    EXPECT_NEAR(Level(slope, s), 2 * Project(PlainCamera(), points[s])->x(), 0.02);
  }
}

TEST(SampleViewByArea, DoesNotAliasFineStripes) {
  const PhotoPixels stripes = Gray([](int x, int) { return 127.5 + 100 * std::sin(2.3 * x); });
  for (const Eigen::Vector2d& a : {Eigen::Vector2d(5, 0), Eigen::Vector2d(4.1, 2.5)}) {
    const auto points = PatchAt({30, 30}, a, {1, 5}, 10);
    const double bilinear = Spread(SampleView(stripes, PlainCamera(), Pose{}, points));
    EXPECT_GT(bilinear, 20);
    EXPECT_LT(Spread(SampleViewByArea(stripes, PlainCamera(), Pose{}, points, 10)), 0.1 * bilinear);
  }
  // Slow ones stay.
  const PhotoPixels slow = Gray([](int x, int) { return 127.5 + 100 * std::sin(0.1 * x); });
  const auto points = PatchAt({30, 30}, {5, 0}, {1, 5}, 10);
  EXPECT_GT(Spread(SampleViewByArea(slow, PlainCamera(), Pose{}, points, 10)),
            0.9 * Spread(SampleView(slow, PlainCamera(), Pose{}, points)));
}

TEST(SampleViewByArea, TakesNothingFromBeyondADepthEdge) {
  // Dark before a bright background, two columns between them that are no data.
  PhotoPixels photo = Gray([](int x, int) { return x < 60 ? 50.0 : 250.0; });
  SetUse(photo, 59, PixelUse::kNearEdge);
  SetUse(photo, 60, PixelUse::kNearEdge);
  const auto points = PatchAt({20.5, 20}, {8, 0}, {0, 8}, 5);
  const SampledView view = SampleViewByArea(photo, PlainCamera(), Pose{}, points, 5);
  for (size_t s = 0; s < points.size(); ++s) {
    EXPECT_EQ(view.knowledge[3 * s], Knowledge::kData);
    EXPECT_NEAR(Level(view, s), 50, 0.01);
  }
  // Of a strip three columns wide the footprint knows too little.
  SetUse(photo, 50, PixelUse::kNearEdge);
  SetUse(photo, 54, PixelUse::kNearEdge);
  const auto at = PatchAt({52, 20}, {0, 8}, {8, 0}, 4);
  const SampledView strip = SampleViewByArea(photo, PlainCamera(), Pose{}, at, 4);
  EXPECT_EQ(SampleView(photo, PlainCamera(), Pose{}, at).knowledge[0], Knowledge::kData);
  EXPECT_EQ(strip.knowledge[0], Knowledge::kMissing);
  EXPECT_EQ(strip.hidden_samples, 0);
}

TEST(SampleViewByArea, HidesWhatIsForbiddenOrOutside) {
  PhotoPixels photo = Gray([](int, int) { return 50.0; });
  SetUse(photo, 40, PixelUse::kForbidden);
  const auto points = PatchAt({40, 30}, {-12, 0}, {0, 5}, 5);  // the last of a row lies outside
  const SampledView view = SampleViewByArea(photo, PlainCamera(), Pose{}, points, 5);
  EXPECT_EQ(view.hidden_samples, 5 + 1);
  EXPECT_EQ(view.knowledge[0], Knowledge::kMissing);
  EXPECT_EQ(view.data_samples, 15 - 6);
}

TEST(SampleViewByArea, BoundsWhatHoldsSaturatedPixels) {
  const PhotoPixels photo = Gray([](int x, int y) { return x == 33 && y == 31 ? 255.0 : 90.0; });
  const auto points = PatchAt({31, 31}, {7, 0}, {0, 7}, 5);
  const SampledView view = SampleViewByArea(photo, PlainCamera(), Pose{}, points, 5);
  EXPECT_EQ(SampleView(photo, PlainCamera(), Pose{}, points).knowledge[0], Knowledge::kData);
  EXPECT_EQ(view.knowledge[0], Knowledge::kLowerBound);
  EXPECT_GT(Level(view, 0), 90.5);
  EXPECT_EQ(view.knowledge[3 * 4], Knowledge::kData);  // 28 pixels away
}

}  // namespace
}  // namespace lfm
