// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/scan_renderer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/parallel.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;

TEST(PatternTable, AddsUpEveryFrameAsThePatternsDefineIt) {
  const PatternSequence sequence = MakePatternSequence(64, 48, PatternRows::kWith);
  const PatternTable table(sequence);
  ASSERT_EQ(table.frames(), static_cast<int>(sequence.patterns.size()));
  std::vector<float> sums(table.frames(), 0.0f);
  table.Accumulate({{37, 0}, {11, 0}, 0.25f}, sums.data());
  table.Accumulate({{5, 0.25f}, {40, 0}, 0.5f}, sums.data());
  for (int slot = 0; slot < table.frames(); ++slot) {
    const Pattern& pattern = sequence.patterns[table.frame_of_slot()[slot]];
    EXPECT_NEAR(sums[slot],
                0.25 * PatternValue(sequence, pattern, 37, 11) +
                    0.375 * PatternValue(sequence, pattern, 5, 40) +
                    0.125 * PatternValue(sequence, pattern, 6, 40),
                1e-6)
        << PatternName(pattern);
  }
}

TEST(ProjectedSpan, CoversItsStretchInsideThePicture) {
  const ProjectedSpan inside = MakeSpan(5.1, 0.4, 10);
  EXPECT_EQ(inside.index, 5);
  EXPECT_EQ(inside.share, 0);
  const ProjectedSpan across = MakeSpan(5.4, 0.4, 10);  // [5.2, 5.6]: a quarter beyond 5.5
  EXPECT_EQ(across.index, 5);
  EXPECT_NEAR(across.share, 0.25, 1e-6);
  EXPECT_EQ(MakeSpan(-0.5, 1, 10).index, 0);
  const ProjectedSpan last = MakeSpan(9.49, 1, 10);
  EXPECT_EQ(last.index, 9 - (last.share > 0));
  EXPECT_EQ(MakeSpan(3, 0, 10).index, 3);
}

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
                      PatternTable(sequence_), ScanExposure(), sensor, seed, 9);
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
