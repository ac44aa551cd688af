// SPDX-License-Identifier: BSD-3-Clause
#include "fields/light_sampling.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "core/error.h"
#include "core/parallel.h"
#include "tests/fields/light_directions.h"
#include "tests/support/scratch_folder.h"

namespace lfm {
namespace {

using Eigen::Vector3d;
constexpr double kPi = std::numbers::pi;

Image Map(int width, int height, const std::function<Vector3d(const Vector3d&)>& radiance) {
  Image image(width, height, 3, PixelType::kFloat32, ColorEncoding::kLinear);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Vector3d value = radiance(ProbeDirection((x + 0.5) / width, (y + 0.5) / height));
      for (int c = 0; c < 3; ++c) image.At<float>(x, y, c) = static_cast<float>(value[c]);
    }
  }
  return image;
}

Vector3d Sky(const Vector3d& d) {
  return {1 + d.x(), 1 + d.z() * d.y(), 0.5 + 0.5 * std::pow(std::max(0.0, d.y()), 4)};
}

Vector3d Total(const LightVector& light) {
  Vector3d total = Vector3d::Zero();
  for (int c = 0; c < 3; ++c) {
    for (int i = 0; i < light.directions; ++i) total[c] += light.Channel(c)[i];
  }
  return total;
}

// The integral of a picture that is constant over each pixel.
Vector3d Integral(const Image& image) {
  Vector3d sum = Vector3d::Zero();
  for (int y = 0; y < image.height(); ++y) {
    const double band =
        std::cos(kPi * y / image.height()) - std::cos(kPi * (y + 1) / image.height());
    for (int x = 0; x < image.width(); ++x) {
      for (int c = 0; c < 3; ++c) {
        sum[c] += 2 * kPi / image.width() * band *
                  image.At<float>(x, y, std::min(c, image.channels() - 1));
      }
    }
  }
  return sum;
}

TEST(LightSampling, AUniformMapGivesEveryCellItsSolidAngle) {
  const LightProbe probe =
      MakeLightProbe(Map(64, 32, [](const Vector3d&) { return Vector3d(1, 2, 0); }), "map");
  for (const double lowest : {-1.0, 0.1}) {
    const LightCells cells = MakeLightCells(FieldColumns::kLights, Spiral(100, lowest));
    for (const double turn : {0.0, 33.3, -725.0}) {
      const LightVector light = SampleProbe(cells, probe, turn);
      for (int i = 0; i < 100; ++i) {
        EXPECT_NEAR(light.Channel(0)[i], cells.solid_angle[i], 1e-6);
        EXPECT_NEAR(light.Channel(1)[i], 2 * cells.solid_angle[i], 1e-6);
        EXPECT_EQ(light.Channel(2)[i], 0);
      }
    }
  }
}

TEST(LightSampling, RotationsKeepTheTotal) {
  std::mt19937 random(4);
  for (const auto& [width, height] :
       {std::pair{1, 1}, {7, 3}, {64, 32}, {1024, 512}, {300, 700}, {2500, 90}}) {
    const Image map = Map(width, height, Sky);
    const LightProbe probe = MakeLightProbe(map, "map");
    const Vector3d expected = Integral(map);
    for (const FieldColumns kind : {FieldColumns::kLights, FieldColumns::kCubeTexels}) {
      const LightCells cells =
          MakeLightCells(kind, kind == FieldColumns::kLights ? Spiral(253, -1) : Cube(8));
      const auto total = [&](LightVector light) {
        if (kind == FieldColumns::kCubeTexels) {
          for (int c = 0; c < 3; ++c) {
            for (int i = 0; i < light.directions; ++i) light.Channel(c)[i] *= cells.solid_angle[i];
          }
        }
        return Total(light);
      };
      for (const double turn : {0.0, 12.3456, 180.0, -77.7, 1e6}) {
        EXPECT_LT((total(SampleProbe(cells, probe, turn)) - expected).norm(),
                  1e-5 * expected.norm());
      }
      // Texels are averages over pixels whose number depends on the angle.
      const double tolerance = kind == FieldColumns::kLights ? 1e-5 : 1e-2;
      EXPECT_LT((total(SampleProbeTurned(cells, probe, RandomRotation(random))) - expected).norm(),
                tolerance * expected.norm());
    }
  }
}

TEST(LightSampling, ABrightPixelGoesToItsNearestLight) {
  const std::vector<Vector3d> directions = Spiral(100, -1);
  const LightCells cells = MakeLightCells(FieldColumns::kLights, directions);
  std::mt19937 random(6);
  int tried = 0;
  while (tried < 10) {
    const int x = static_cast<int>(random() % 512), y = static_cast<int>(random() % 256);
    const double turn = 0.1 * static_cast<double>(random() % 3600);
    const Vector3d in_map = ProbeDirection((x + 0.5) / 512, (y + 0.5) / 256);
    const Vector3d turned = Eigen::AngleAxisd(turn * kPi / 180, Vector3d::UnitZ()) * in_map;
    const Eigen::Matrix3d rotation = RandomRotation(random);
    // Not at a border between cells.
    const auto inside = [&](const Vector3d& d) {
      const int nearest = Nearest(directions, d);
      for (int i = 0; i < 100; ++i) {
        if (i != nearest &&
            std::acos(directions[i].dot(d)) < std::acos(directions[nearest].dot(d)) + 0.04) {
          return false;
        }
      }
      return true;
    };
    if (!inside(turned) || !inside(rotation * in_map)) continue;
    ++tried;
    Image map(512, 256, 3, PixelType::kFloat32, ColorEncoding::kLinear);
    map.At<float>(x, y, 1) = 1000;
    const LightProbe probe = MakeLightProbe(map, "map");
    const float expected = static_cast<float>(Integral(map)[1]);
    const LightVector about_z = SampleProbe(cells, probe, turn);
    const LightVector free = SampleProbeTurned(cells, probe, rotation);
    for (int i = 0; i < 100; ++i) {
      EXPECT_NEAR(about_z.Channel(1)[i], i == Nearest(directions, turned) ? expected : 0,
                  1e-4 * expected);
      EXPECT_NEAR(free.Channel(1)[i], i == Nearest(directions, rotation * in_map) ? expected : 0,
                  1e-4 * expected);
    }
  }
}

TEST(LightSampling, BothRotationsAgree) {
  const LightProbe probe = MakeLightProbe(Map(256, 128, Sky), "map");
  for (const FieldColumns kind : {FieldColumns::kLights, FieldColumns::kCubeTexels}) {
    const LightCells cells =
        MakeLightCells(kind, kind == FieldColumns::kLights ? Spiral(60, -1) : Cube(4));
    for (const double turn : {0.0, 40.0, -100.0}) {
      const LightVector a = SampleProbe(cells, probe, turn);
      const LightVector b = SampleProbeTurned(
          cells, probe, Eigen::AngleAxisd(turn * kPi / 180, Vector3d::UnitZ()).toRotationMatrix());
      float largest = 0;
      for (const float v : a.values) largest = std::max(largest, v);
      for (size_t i = 0; i < a.values.size(); ++i) {
        EXPECT_NEAR(a.values[i], b.values[i], 0.02 * largest);
      }
    }
  }
}

TEST(LightSampling, TurnsTheSurroundingsCounterclockwise) {
  // The sun over +x, turned by 90 degrees, shines from +y.
  const LightProbe probe =
      MakeLightProbe(Map(360, 180,
                         [](const Vector3d& d) -> Vector3d {
                           return d.x() > 0.99 ? Vector3d::Ones() : Vector3d::Zero();
                         }),
                     "map");
  const std::vector<Vector3d> axes = {{1, 0, 0},  {0, 1, 0},  {0, 0, 1},
                                      {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  const LightCells cells = MakeLightCells(FieldColumns::kLights, axes);
  EXPECT_GT(SampleProbe(cells, probe, 0).Channel(0)[0], 0.05);
  EXPECT_GT(SampleProbe(cells, probe, 90).Channel(0)[1], 0.05);
  EXPECT_GT(SampleProbe(cells, probe, -90).Channel(0)[4], 0.05);
  EXPECT_EQ(SampleProbe(cells, probe, 90).Channel(0)[0], 0);
}

TEST(LightSampling, TexelsTakeMeanRadiance) {
  const LightProbe probe =
      MakeLightProbe(Map(128, 64, [](const Vector3d&) { return Vector3d(3, 1, 2); }), "map");
  for (const int resolution : {1, 8, 40, 200}) {  // the last with texels between all places
    const LightCells cells = MakeLightCells(FieldColumns::kCubeTexels, Cube(resolution));
    std::mt19937 random(2);
    for (const LightVector& light :
         {SampleProbe(cells, probe, 20), SampleProbeTurned(cells, probe, RandomRotation(random))}) {
      for (int i = 0; i < light.directions; ++i) {
        ASSERT_NEAR(light.Channel(0)[i], 3, 1e-4);
        ASSERT_NEAR(light.Channel(2)[i], 2, 1e-4);
      }
    }
  }
}

TEST(LightSampling, DoesNotDependOnThreads) {
  const LightProbe probe = MakeLightProbe(Map(100, 50, Sky), "map");
  const LightCells cells = MakeLightCells(FieldColumns::kLights, Spiral(80, -1));
  std::mt19937 random(2);
  const Eigen::Matrix3d rotation = RandomRotation(random);
  SetThreadCount(1);
  const LightVector one = SampleProbeTurned(cells, probe, rotation);
  SetThreadCount(3);
  EXPECT_EQ(one.values, SampleProbeTurned(cells, probe, rotation).values);
  SetThreadCount(0);
}

TEST(LightSampling, ADirectionIsExactAtTheLightsAndPredictsBetweenThem) {
  const std::vector<Vector3d> directions = Spiral(253, -1);
  const LightCells cells = MakeLightCells(FieldColumns::kLights, directions);
  const LightTriangulation lights = TriangulateLights(directions);
  for (const int i : {0, 17, 252}) {
    const LightVector light = SampleDirection(cells, lights, 1e-30 * directions[i]);
    for (int k = 0; k < 253; ++k) EXPECT_NEAR(light.values[k], k == i ? 1 : 0, 1e-6);
  }
  // A smooth reflectance function is met between its samples.
  const auto reflectance = [](const Vector3d& d) {
    return std::exp(2 * (d.z() - 1)) + 0.2 * d.x();
  };
  std::mt19937 random(3);
  for (int i = 0; i < 100; ++i) {
    const Vector3d d = RandomRotation(random).col(0);
    const LightVector light = SampleDirection(cells, lights, d);
    double sum = 0, predicted = 0;
    for (int k = 0; k < 253; ++k) {
      sum += light.values[k];
      predicted += light.values[k] * reflectance(directions[k]);
    }
    EXPECT_NEAR(sum, 1, 1e-6);
    EXPECT_NEAR(predicted, reflectance(d), 0.015);
  }
}

TEST(LightSampling, ParallelLightOnACubeHasIrradianceOne) {
  const LightCells cells = MakeLightCells(FieldColumns::kCubeTexels, Cube(8));
  const LightTriangulation lights = TriangulateLights(cells.directions);
  EXPECT_TRUE(lights.Surrounds());
  const LightVector light = SampleDirection(cells, lights, {0.3, -0.5, 0.2});
  double irradiance = 0;  // radiance times solid angle
  for (int i = 0; i < light.directions; ++i) irradiance += light.values[i] * cells.solid_angle[i];
  EXPECT_NEAR(irradiance, 1, 0.02);  // the cells' solid angles are counted in places
}

TEST(LightSampling, ACapIsTheMeanOfItsDirections) {
  const std::vector<Vector3d> directions = Spiral(20, -1);
  const LightCells cells = MakeLightCells(FieldColumns::kLights, directions);
  const LightTriangulation lights = TriangulateLights(directions);
  const Vector3d to_light(0.2, 0.5, 0.7);
  const LightVector point = SampleDirection(cells, lights, to_light);
  EXPECT_EQ(SampleCap(cells, lights, to_light, 0).values, point.values);
  const LightVector small = SampleCap(cells, lights, to_light, 0.01);
  const LightVector all = SampleCap(cells, lights, to_light, 180);
  double sum = 0;
  for (int i = 0; i < 20; ++i) {
    EXPECT_NEAR(small.values[i], point.values[i], 1e-2);
    EXPECT_NEAR(all.values[i], 1 / 20.0, 0.025);
    sum += SampleCap(cells, lights, to_light, 30).values[i];
  }
  EXPECT_NEAR(sum, 1, 1e-5);
}

TEST(LightSampling, TakesGrayAndAlpha) {
  Image gray(4, 2, 1, PixelType::kFloat32, ColorEncoding::kLinear);
  Image rgba(4, 2, 4, PixelType::kFloat32, ColorEncoding::kLinear);
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 4; ++x) {
      gray.At<float>(x, y) = 1;
      for (int c = 0; c < 3; ++c) rgba.At<float>(x, y, c) = 1;
      rgba.At<float>(x, y, 3) = std::numeric_limits<float>::infinity();
    }
  }
  const LightCells cells = MakeLightCells(FieldColumns::kLights, Spiral(30, -1));
  EXPECT_EQ(SampleProbe(cells, MakeLightProbe(gray, "map")).values,
            SampleProbe(cells, MakeLightProbe(rgba, "map")).values);
}

TEST(LightSampling, RefusesWhatIsNoLight) {
  const auto refused = [](const Image& map) { EXPECT_THROW(MakeLightProbe(map, "map"), Error); };
  refused({});
  refused(Image(4, 2, 3, PixelType::kUint8, ColorEncoding::kSrgb));
  Image bad = Map(4, 2, Sky);
  bad.At<float>(1, 1, 0) = -1;
  refused(bad);
  bad.At<float>(1, 1, 0) = std::numeric_limits<float>::quiet_NaN();
  refused(bad);
  const ScratchFolder scratch;
  EXPECT_THROW(ReadLightProbe(scratch.folder / "absent.hdr"), Error);
  const LightProbe probe = MakeLightProbe(Map(4, 2, Sky), "map");
  const LightCells cells = MakeLightCells(FieldColumns::kLights, Spiral(30, -1));
  const LightTriangulation lights = TriangulateLights(cells.directions);
  EXPECT_THROW(SampleProbe(cells, probe, std::nan("")), Error);
  EXPECT_THROW(SampleProbeTurned(cells, probe, 2 * Eigen::Matrix3d::Identity()), Error);
  EXPECT_THROW(SampleDirection(cells, lights, {0, 0, 0}), Error);
  EXPECT_THROW(SampleDirection(cells, lights, {0, std::nan(""), 0}), Error);
  EXPECT_THROW(SampleCap(cells, lights, {0, 0, 1}, 181), Error);
}

}  // namespace
}  // namespace lfm
