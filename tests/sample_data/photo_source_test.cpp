// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/photo_source.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sample_data/camera_path.h"
#include "sample_data/scene_file.h"
#include "sample_data/studio_report.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;

Camera SmallCamera() { return MakePhotoCamera(120, 90); }
Pose Eye() { return LookAt(V3(120, -330, 260), V3(0, 0, 45), V3::UnitZ()); }

// A thick stick between the key lamps and the plate, before the camera's picture.
Occluder Bar() {
  Occluder bar;
  bar.albedo = {0.4f, 0.3f, 0.2f};
  bar.capsules = {{V3(-250, -120, 158), V3(250, -120, 158), 14}};
  return bar;
}

// Where no ray of a pixel meets the bar.
Image Uncovered(const Occluder& bar, const PixelRays& rays, const Pose& pose) {
  Occluder wide = bar;
  for (Capsule& c : wide.capsules) c.radius += 4;
  Image free(rays.camera().width, rays.camera().height, 1, PixelType::kUint8, ColorEncoding::kSrgb);
  for (size_t i = 0; i < free.size(); ++i) free.Data<uint8_t>()[i] = 255;
  MaskOccluder(wide, rays, pose, free);
  return free;
}

class PhotoSourceTest : public testing::Test {
 protected:
  PhotoSourceTest()
      : reflectance_(board_),
        rays_(SmallCamera()),
        table_{Eigen::Matrix3d::Identity(), {0, 0, -kPlateThicknessMm}} {}

  // What all sources must do with something in the way.
  void ExpectShadow(const PhotoSource& source) const {
    const RenderedPhoto open = source.Render(rays_, Eye());
    const RenderedPhoto covered = source.WithOccluder(Bar())(rays_, Eye());
    const Image free = Uncovered(Bar(), rays_, Eye());
    int hidden = 0, darker = 0, brighter = 0;
    for (int y = 0; y < 90; ++y) {
      for (int x = 0; x < 120; ++x) {
        const bool bar = free.At<uint8_t>(x, y) == 0;
        if (bar) {
          hidden += open.mask.At<uint8_t>(x, y) > covered.mask.At<uint8_t>(x, y);
          continue;
        }
        EXPECT_EQ(open.mask.At<uint8_t>(x, y), covered.mask.At<uint8_t>(x, y));
        const float before = open.radiance.At<float>(x, y, 1);
        const float after = covered.radiance.At<float>(x, y, 1);
        darker += after < 0.9f * before;
        brighter += after > 1.3f * before;
      }
    }
    EXPECT_GT(hidden, 20);
    EXPECT_GT(darker, 300);  // the shadow beside it
    EXPECT_LT(brighter, darker / 4);
  }

  Board board_ = DefaultBoard();
  SetReflectance reflectance_;
  PixelRays rays_;
  Pose table_;
};

TEST_F(PhotoSourceTest, BakedLightHasTheShadowOfWhatIsInTheWay) {
  const Subject bust = MakeBust(4, 1);
  const StudioScene scene(&bust.mesh, MakePlateAndTable(board_, table_));
  BakeOptions options;
  options.gather_rays = 32;
  options.rays_per_cell = 4;
  options.plate_spacing_mm = 2;
  const auto source = MakeBakedSource(scene, bust, reflectance_, options, SilentProgress());
  ExpectShadow(*source);
}

TEST_F(PhotoSourceTest, TracedScenesHaveTheShadowOfWhatIsInTheWay) {
  const SceneDescription matte = FindScene("matte", SceneDetail::kTiny);
  const auto source =
      MakeTracedSource(matte, MakePlateAndTable(board_, table_), reflectance_, 16, 1, 1);
  ExpectShadow(*source);
  EXPECT_FALSE(source->RenderAgain(rays_, Eye()));
}

// The second bake tells the first one's error: it falls with the number of rays.
TEST_F(PhotoSourceTest, MoreRaysMakeTheTwoBakesMoreAlike) {
  const Subject bust = MakeBust(4, 1);
  const StudioScene scene(&bust.mesh, MakePlateAndTable(board_, table_));
  const auto error = [&](int gather_rays) {
    BakeOptions options;
    options.gather_rays = gather_rays;
    options.rays_per_cell = 4;
    options.plate_spacing_mm = 2;
    const auto source = MakeBakedSource(scene, bust, reflectance_, options, SilentProgress());
    EXPECT_EQ(source->LightingRays().camera, 0);
    EXPECT_GT(source->LightingRays().bounce, 0);
    EXPECT_GT(source->LightingRays().shadow, 0);
    const auto again = source->RenderAgain(rays_, Eye());
    EXPECT_TRUE(again);
    const float exposure = static_cast<float>(0.68 / source->BrightestPaper());
    return TallyDifferences(source->Render(rays_, Eye()).radiance, again->radiance, exposure,
                            Sensor())
        .MonteCarloRms();
  };
  const double few = error(64), many = error(256);
  EXPECT_GT(few, 0);
  // Independent rays would halve it; a lattice does better.
  EXPECT_LT(many, 0.6 * few);
}

}  // namespace
}  // namespace lfm
