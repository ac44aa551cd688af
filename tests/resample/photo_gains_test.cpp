// SPDX-License-Identifier: BSD-3-Clause
#include "resample/photo_gains.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <random>

#include "core/atomic_file.h"
#include "core/image.h"
#include "core/json_reader.h"
#include "resample/resample.h"
#include "test_scenes.h"

namespace lfm {
namespace {

constexpr size_t kPhotos = 40;

/// Eyes all around, and what they show of triangles that face everywhere: diffuse colours, a
/// Fresnel rise, and highlights of `gloss` from one lamp.
std::vector<TriangleShades> ShadesOfScene(const std::vector<Eigen::Vector3d>& gains, double gloss,
                                          int triangles = 400) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0.05, 0.4);
  const auto anywhere = [&] {
    return Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
  };
  std::vector<Eigen::Vector3d> eyes(gains.size());
  for (Eigen::Vector3d& eye : eyes) eye = anywhere();
  const Eigen::Vector3d lamp = Eigen::Vector3d(1, 2, 3).normalized();
  std::vector<TriangleShades> all(static_cast<size_t>(triangles));
  for (TriangleShades& shades : all) {
    const Eigen::Vector3d n = anywhere(), x = n.unitOrthogonal(), y = n.cross(x);
    const Eigen::Vector3d albedo(uniform(random), uniform(random), uniform(random));
    const double shine = uniform(random);
    for (size_t p = 0; p < eyes.size(); ++p) {
      const double cosine = eyes[p].dot(n);
      if (cosine < 0.2) continue;
      const Eigen::Vector3d mirrored = 2 * cosine * n - eyes[p];
      const double highlight = gloss * shine * std::pow(std::max(0.0, mirrored.dot(lamp)), 60) +
                               0.1 * gloss * shine * std::pow(1 - cosine, 5);
      const Eigen::Vector3d noise(normal(random), normal(random), normal(random));
      shades.photos.push_back(static_cast<uint16_t>(p));
      shades.radiance.push_back(
          gains[p].cwiseProduct(albedo + Eigen::Vector3d::Constant(highlight)) + 0.001 * noise);
      shades.directions.emplace_back(x.dot(eyes[p]), y.dot(eyes[p]));
    }
  }
  return all;
}

std::vector<Eigen::Vector3d> DrawGains(size_t count, double stops, double balance) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  std::vector<Eigen::Vector3d> gains(count);
  for (Eigen::Vector3d& gain : gains) {
    gain = Eigen::Vector3d::Constant(std::exp2(stops * normal(random)));
    gain.x() *= std::exp(balance * normal(random));
    gain.z() *= std::exp(balance * normal(random));
  }
  return gains;
}

/// RMS of log(found / true) over photographs and channels, the common factor taken out.
double LogError(const std::vector<Eigen::Vector3d>& found,
                const std::vector<Eigen::Vector3d>& truth) {
  double squares = 0;
  for (int c = 0; c < 3; ++c) {
    Eigen::VectorXd difference(static_cast<Eigen::Index>(found.size()));
    for (size_t p = 0; p < found.size(); ++p) {
      difference[static_cast<Eigen::Index>(p)] = std::log(found[p][c] / truth[p][c]);
    }
    squares += (difference.array() - difference.mean()).square().sum();
  }
  return std::sqrt(squares / static_cast<double>(3 * found.size()));
}

TEST(PhotoGains, AreFoundOnDullAndGlossyScenes) {
  // Gains differ by 21 % in exposure; what highlights leave of it. The last scene's are ten times
  // as bright as its paint.
  struct Case {
    double gloss, error;
  };
  const auto truth = DrawGains(kPhotos, 0.3, 0.05);
  for (const Case& expected : {Case{0, 0.01}, Case{1, 0.06}, Case{10, 0.12}}) {
    const PhotoGains found = EstimatePhotoGains(ShadesOfScene(truth, expected.gloss), kPhotos);
    EXPECT_LT(LogError(found.gains, truth), expected.error) << expected.gloss;
    EXPECT_TRUE(found.Needed()) << found.error_with << " of " << found.error_without;
    for (int c = 0; c < 3; ++c) {
      double mean_log = 0;
      for (const auto& gain : found.gains) mean_log += std::log(gain[c]);
      EXPECT_NEAR(mean_log, 0, 1e-9);
    }
  }
}

TEST(PhotoGains, AreNotNeededWhereThereAreNone) {
  const std::vector<Eigen::Vector3d> ones(kPhotos, Eigen::Vector3d::Ones());
  for (const double gloss : {0.0, 1.0, 10.0}) {
    const PhotoGains found = EstimatePhotoGains(ShadesOfScene(ones, gloss), kPhotos);
    EXPECT_FALSE(found.Needed()) << found.error_with << " of " << found.error_without;
    EXPECT_GT(found.error_without, 0);
  }
}

TEST(PhotoGains, OfSmallDifferencesAreNeededToo) {
  const auto truth = DrawGains(kPhotos, 0.05, 0.01);
  EXPECT_TRUE(EstimatePhotoGains(ShadesOfScene(truth, 1), kPhotos).Needed());
}

TEST(PhotoGains, DefineTheExtremes) {
  for (const size_t photos : {size_t{0}, size_t{1}, size_t{5}}) {
    const PhotoGains none = EstimatePhotoGains({}, photos);
    EXPECT_EQ(none.gains.size(), photos);
    EXPECT_FALSE(none.Needed());
  }
  // A photograph that nobody can compare, darkness, and values that are no radiance.
  const auto truth = DrawGains(kPhotos, 0.3, 0.05);
  std::vector<TriangleShades> shades = ShadesOfScene(truth, 1);
  for (size_t i = 0; i < shades[0].radiance.size(); ++i) shades[0].radiance[i].setZero();
  for (size_t i = 0; i < shades[1].radiance.size(); ++i) shades[1].radiance[i].setConstant(-1);
  shades[2].radiance[0].setConstant(std::numeric_limits<double>::quiet_NaN());
  const PhotoGains found = EstimatePhotoGains(shades, kPhotos + 1);
  for (const auto& gain : found.gains) {
    EXPECT_TRUE(gain.allFinite());
    EXPECT_TRUE((gain.array() > 0).all());
  }
  EXPECT_EQ(found.gains.back(), Eigen::Vector3d::Ones());
  // All black: nothing can be told, nothing is needed.
  for (TriangleShades& triangle : shades) {
    for (auto& radiance : triangle.radiance) radiance.setZero();
  }
  const PhotoGains black = EstimatePhotoGains(shades, kPhotos);
  EXPECT_FALSE(black.Needed());
  for (const auto& gain : black.gains) EXPECT_NEAR(gain.x(), 1, 1e-6);
}

TEST(ExposureSpreadStops, IsTheStandardDeviation) {
  EXPECT_EQ(ExposureSpreadStops({}), 0);
  EXPECT_NEAR(ExposureSpreadStops({{1, 2, 1}, {1, 0.5, 1}}), 1, 1e-12);
}

Eigen::Vector3d SmoothColor(const Eigen::Vector3d& p) {
  return {0.4 + p.x() / 150, 0.4 + p.y() / 150, 0.35 + p.z() / 150};
}

class PhotoGainsOfCapture : public ::testing::Test {
 protected:
  static constexpr double kRadius = 40;
  PhotoGainsOfCapture()
      : made_(test::MakeCapture(test::Sphere({0, 0, 0}, kRadius, 4),
                                test::TestCamera(160, 120, 280), test::PosesAround(20, 260),
                                SmoothColor, {0, 0, 0}, 2)) {}

  /// Exposes every photograph anew.
  void Expose(const std::vector<Eigen::Vector3d>& gains) {
    for (size_t p = 0; p < gains.size(); ++p) {
      Image& picture = made_.pictures.at(made_.capture.photos[p].file);
      for (int y = 0; y < picture.height(); ++y) {
        for (int x = 0; x < picture.width(); ++x) {
          for (int c = 0; c < 3; ++c) {
            uint8_t& value = picture.At<uint8_t>(x, y, c);
            const double linear = LinearFromSrgb(static_cast<float>(value) / 255) * gains[p][c];
            value = static_cast<uint8_t>(
                std::lround(255 * std::min(1.0F, SrgbFromLinear(static_cast<float>(linear)))));
          }
        }
      }
    }
  }

  ResampleResult Run(PhotoGainUse use, const std::filesystem::path& file) {
    ResampleOptions options;
    options.view_grid = 8;
    options.photo_gains = use;
    return Resample(made_.capture, made_.calib, test::Sphere({0, 0, 0}, kRadius, 4),
                    test::Sphere({0, 0, 0}, kRadius, 2), made_.Loader(), options, file,
                    SilentProgress());
  }

  test::MemoryCapture made_;
};

TEST_F(PhotoGainsOfCapture, ChangeNoByteWhereTheyAreNotNeeded) {
  const auto folder = test::TestFolder("no_gains");
  const ResampleResult result = Run(PhotoGainUse::kAuto, folder / "auto.lfs");
  EXPECT_TRUE(result.photo_gains.empty());
  EXPECT_GT(result.gain_error_without, 0);
  EXPECT_TRUE(Run(PhotoGainUse::kOff, folder / "off.lfs").photo_gains.empty());
  EXPECT_EQ(ReadFile(folder / "auto.lfs"), ReadFile(folder / "off.lfs"));
  EXPECT_FALSE(Run(PhotoGainUse::kOn, folder / "on.lfs").photo_gains.empty());
}

TEST_F(PhotoGainsOfCapture, BringPhotographsToOneExposure) {
  const auto folder = test::TestFolder("gains");
  const auto truth = DrawGains(made_.capture.photos.size(), 0.3, 0.03);
  Expose(truth);
  const ResampleResult result = Run(PhotoGainUse::kAuto, folder / "light_field.lfs");
  ASSERT_EQ(result.photo_gains.size(), truth.size());
  constexpr double kError_rel = 0.02;  // of gains that differ by 21 %
  EXPECT_LT(LogError(result.photo_gains, truth), kError_rel);

  // Each sample is the same in every view that shows it, saturated ones apart.
  const LightField field = LightField::Open(folder / "light_field.lfs");
  double squares = 0, count = 0;
  for (int t = 0; t < field.triangle_count(); ++t) {
    const TrianglePatch patch = field.Patch(t);
    const size_t views = patch.photos.size();
    for (size_t row = 0; row < (views > 0 ? patch.values.size() / views : 0); ++row) {
      double mean = 0;
      for (size_t v = 0; v < views; ++v) mean += double(patch.values[row * views + v]) / views;
      for (size_t v = 0; v < views; ++v) {
        squares += std::pow((patch.values[row * views + v] - mean) / LightField::kOne, 2);
        count += 1;
      }
    }
  }
  EXPECT_GT(count, 1e4);
  EXPECT_LT(std::sqrt(squares / count), 0.015);  // 0.06 as the photographs stand
}

TEST_F(PhotoGainsOfCapture, AreWrittenWithTheirPhotographs) {
  const auto folder = test::TestFolder("gains_file");
  SavePhotoGains({"a", "b"}, {{1, 2, 3}, {4, 5, 6}}, folder);
  const auto json = ReadJson(folder / "photo_gains.json");
  EXPECT_TRUE(json.at("applied").get<bool>());
  EXPECT_EQ(json.at("photos").at(1).at("id"), "b");
  EXPECT_EQ(json.at("photos").at(1).at("gains").at(2), 6);
  SavePhotoGains({"a", "b"}, {}, folder);
  EXPECT_FALSE(ReadJson(folder / "photo_gains.json").at("applied").get<bool>());
}

}  // namespace
}  // namespace lfm
