// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/scan_renderer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <tuple>

#include "core/parallel.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;

class PlaneScanTest : public testing::Test {
 protected:
  PlaneScanTest()
      : board_(DefaultBoard()),
        reflectance_(board_),
        placement_(MakePlacements(1)[0]),
        scene_(nullptr, MakePlateAndTable(board_, placement_.world_from_table)),
        rig_(MakeScanRig(80, 60, 128, 96)),
        rays_(rig_.camera),
        sequence_(MakePatternSequence(128, 96, PatternRows::kWith)) {}

  std::vector<Image> Render(const Sensor& sensor, uint64_t seed) const {
    return RenderScan({&scene_, nullptr, &reflectance_}, rig_, rays_, placement_.camera_from_world,
                      PatternTable(sequence_), ScanExposure(), sensor, seed, 9)
        .pictures;
  }

  struct Truth {
    std::vector<double> frames;  // linear
    bool print_edge = false;
  };

  // What a pixel of each frame would be, from plane geometry and dense sampling: no rays, no
  // tables.
  Truth Expected(int x, int y) const {
    constexpr int kSide = 16;
    const Pose world_from_camera = placement_.camera_from_world.Inverse();
    const Pose projector_from_world = rig_.projector_from_camera * placement_.camera_from_world;
    const BoardPrint print(board_);
    const V3 lamp = projector_from_world.Center(), eye = world_from_camera.translation;
    Truth truth;
    truth.frames.assign(sequence_.patterns.size(), 0);
    double first_print = -1;
    for (int i = 0; i < kSide * kSide; ++i) {
      const V3 ray = world_from_camera.rotation *
                     Unproject(rig_.camera, {x - 0.5 + (i % kSide + 0.5) / kSide,
                                             y - 0.5 + (i / kSide + 0.5) / kSide});
      const V3 point = eye - eye.z() / ray.z() * ray;
      const double value = print.Value(point.head<2>());
      if (i == 0) first_print = value;
      truth.print_edge |= value != first_print;
      const double albedo = 0.035 + value * (kPaperAlbedo - 0.035);
      const V3 in_projector = projector_from_world * point;
      const auto pixel = Project(rig_.projector, in_projector);
      const double falloff =
          std::pow(kNearMm / in_projector.z(), 2) * (lamp - point).z() / in_projector.z();
      for (size_t f = 0; f < truth.frames.size(); ++f) {
        const double shown = PatternValue(sequence_, sequence_.patterns[f], pixel->x(), pixel->y());
        truth.frames[f] += albedo / kPaintAlbedo *
                           (exposure_.white * falloff * shown + exposure_.ambient) /
                           (kSide * kSide);
      }
    }
    return truth;
  }

  Board board_;
  SetReflectance reflectance_;
  PlatformPlacement placement_;
  StudioScene scene_;
  ScanRig rig_;
  PixelRays rays_;
  PatternSequence sequence_;
  ScanExposure exposure_;
};

TEST_F(PlaneScanTest, FramesOfThePlateFollowClosedForm) {
  // White paper is 0.5: sixteen samples, smoothed along the stripes but not at print edges.
  constexpr double kStripe_abs = 0.03, kPrintEdge_abs = 0.07;
  const std::vector<Image> frames = Render({1e12, 0}, 1);
  int plain = 0;
  for (int y = 20; y < 45; y += 6) {
    for (int x = 25; x < 60; x += 7) {
      const Truth truth = Expected(x, y);
      plain += !truth.print_edge;
      for (size_t f = 0; f < frames.size(); ++f) {
        EXPECT_NEAR(LinearFromSrgb(frames[f].At<uint8_t>(x, y) / 255.0f), truth.frames[f],
                    truth.print_edge ? kPrintEdge_abs : kStripe_abs)
            << PatternName(sequence_.patterns[f]) << " at " << x << " " << y;
      }
    }
  }
  EXPECT_GT(plain, 8);
}

TEST_F(PlaneScanTest, WhiteIsBrightAndNotSaturated) {
  const std::vector<Image> frames = Render(Sensor(), 1);
  const Image& white = frames[0];
  int brightest = 0;
  for (size_t i = 0; i < white.size(); ++i) {
    brightest = std::max<int>(brightest, white.Data<uint8_t>()[i]);
  }
  EXPECT_GT(brightest, 180);
  EXPECT_LT(brightest, 250);
}

TEST_F(PlaneScanTest, ExposureAmbientAndSaturationAreTheStatedFactors) {
  ScanTrouble trouble;
  trouble.exposure_factor = 0.5;
  trouble.ambient_light = 0.1;
  const auto render = [&](const ScanTrouble& t) {
    return RenderScan({&scene_, nullptr, &reflectance_}, rig_, rays_, placement_.camera_from_world,
                      PatternTable(sequence_, t), MakeScanExposure(t), {1e12, 0}, 1, 9)
        .pictures;
  };
  const std::vector<Image> usual = render({}), other = render(trouble);
  trouble.exposure_factor = 8;
  const std::vector<Image> burnt = render(trouble);
  const auto linear = [](const Image& image, int x, int y) {
    return LinearFromSrgb(image.At<uint8_t>(x, y) / 255.0f);
  };
  int saturated = 0;
  for (int y = 20; y < 45; y += 5) {
    for (int x = 25; x < 60; x += 5) {
      const double white = linear(usual[0], x, y), black = linear(usual[1], x, y);
      const double dark = 0.5 * black * 0.1 / 0.015;
      EXPECT_NEAR(linear(other[1], x, y), dark, 0.004);
      EXPECT_NEAR(linear(other[0], x, y), 0.5 * (white - black) + dark, 0.008);
      saturated += burnt[0].At<uint8_t>(x, y) == 255;
    }
  }
  EXPECT_GT(saturated, 10);
}

// A ball painted white under a coarse pattern, seen and lit from the front.
TEST(SubsurfaceTest, BlursTheFringesOfThePaintAndNotThePlate) {
  TriangleMesh slab;  // a tilted square 40 mm above the plate
  slab.vertices = {{-40, -40, 40}, {40, -40, 40}, {40, 40, 90}, {-40, 40, 90}};
  slab.triangles = {{0, 1, 2}, {0, 2, 3}};
  const V3 normal = V3(0, -50, 80).normalized();
  slab.normals.assign(4, normal);
  const Board board = DefaultBoard();
  const SetReflectance reflectance(board);
  const StudioScene scene(&slab,
                          MakePlateAndTable(board, {Eigen::Matrix3d::Identity(), {0, 0, -5}}));
  const ScanRig rig = MakeScanRig(80, 60, 256, 192);
  const PixelRays rays(rig.camera);
  PatternSequence sequence = MakePatternSequence(256, 192, PatternRows::kWithout);
  const Pose pose = MakeScanPoses(1, 36, 48)[0];
  const auto swing = [&](double subsurface_mm, int x, int y) {
    ScanTrouble trouble;
    trouble.subsurface_mm = subsurface_mm;
    const std::vector<Image> frames =
        RenderScan({&scene, &slab, &reflectance}, rig, rays, pose, PatternTable(sequence, trouble),
                   MakeScanExposure(trouble), {1e12, 0}, 1, 9)
            .pictures;
    double c = 0, s = 0, mean = 0;
    for (size_t f = 0; f < frames.size(); ++f) {
      const Pattern& p = sequence.patterns[f];
      if (p.kind != PatternKind::kPhase) continue;
      const double value = LinearFromSrgb(frames[f].At<uint8_t>(x, y) / 255.0f);
      c += value * std::cos(std::numbers::pi / 4 * p.index);
      s += value * std::sin(std::numbers::pi / 4 * p.index);
      mean += value;
    }
    return std::tuple(std::hypot(c, s), std::atan2(s, c), mean);
  };
  const auto on_slab = Project(rig.camera, pose * V3(0, 0, 65));
  ASSERT_TRUE(on_slab);
  const int x = static_cast<int>(std::lround(on_slab->x()));
  const int y = static_cast<int>(std::lround(on_slab->y()));
  const auto [sharp, sharp_phase, sharp_mean] = swing(0, x, y);
  const auto [soft, soft_phase, soft_mean] = swing(2, x, y);
  // The fringes' period on the slab, from where its points are lit from.
  const Pose projector_from_world = rig.projector_from_camera * pose;
  const auto column = [&](const V3& p) {
    return Project(rig.projector, projector_from_world * p)->x();
  };
  const V3 up = normal.cross(V3::UnitX());
  const double per_mm =
      std::hypot(column(V3(0.5, 0, 65)) - column(V3(-0.5, 0, 65)),
                 column(V3(0, 0, 65) + 0.5 * up) - column(V3(0, 0, 65) - 0.5 * up));
  const double radians = 2 * std::numbers::pi * 2 * per_mm / 16;
  EXPECT_NEAR(soft / sharp, std::exp(-0.5 * radians * radians), 0.03);
  EXPECT_LT(soft / sharp, 0.8);
  // The blurred fringes are where the pixel's point is lit from; the sharp ones have the steps of
  // the projector's pixels.
  const V3 ray = pose.rotation.transpose() *
                 Unproject(rig.camera, {static_cast<double>(x), static_cast<double>(y)});
  const V3 eye = pose.Center();
  const V3 seen = eye + (V3(0, 0, 65) - eye).dot(normal) / ray.dot(normal) * ray;
  const double phase = 2 * std::numbers::pi * column(seen) / 16;
  EXPECT_NEAR(std::remainder(soft_phase - phase, 2 * std::numbers::pi), 0, 0.02);
  EXPECT_NEAR(std::remainder(sharp_phase - phase, 2 * std::numbers::pi), 0, 0.2);
  EXPECT_NEAR(soft_mean / sharp_mean, 1, 0.01);
  const auto on_plate = Project(rig.camera, pose * V3(75, -60, 0));
  const int px = static_cast<int>(std::lround(on_plate->x()));
  const int py = static_cast<int>(std::lround(on_plate->y()));
  const auto [plate_sharp, p1, m1] = swing(0, px, py);
  const auto [plate_soft, p2, m2] = swing(2, px, py);
  EXPECT_GT(plate_sharp, 0.1);
  EXPECT_NEAR(plate_soft, plate_sharp, 0.02 * plate_sharp);
}

TEST_F(PlaneScanTest, DependsOnTheSeedAndNotOnThreads) {
  SetThreadCount(1);
  const std::vector<Image> one = Render(Sensor(), 1);
  SetThreadCount(3);
  const std::vector<Image> three = Render(Sensor(), 1);
  SetThreadCount(0);
  const std::vector<Image> other = Render(Sensor(), 2);
  for (size_t f = 0; f < one.size(); ++f) ASSERT_EQ(one[f].Bytes(), three[f].Bytes());
  EXPECT_NE(one[0].Bytes(), other[0].Bytes());
}

}  // namespace
}  // namespace lfm
