// SPDX-License-Identifier: BSD-3-Clause
// Models with codebooks and with pages in blocks look in OpenGL as in the reference renderer.
#include <gtest/gtest.h>

#include <set>

#include "core/image_metrics.h"
#include "synthetic_model.h"
#include "tests/viewer/compressed_models.h"
#include "viewer/egl_context.h"
#include "viewer/gl_framebuffer.h"
#include "viewer/gl_renderer.h"
#include "viewer/orbit_camera.h"
#include "viewer/reference_renderer.h"

namespace lfm {
namespace {

constexpr double kMinPsnrDb = 45;
constexpr int kWidth = 200, kHeight = 160;

class GlCompressedModel : public testing::Test {
 protected:
  void ExpectSamePictures(const LightFieldModel& model, BlockUse block_use = BlockUse::kAsTheyAre) {
    const GlRenderer gl(model, block_use);
    const ReferenceRenderer reference(model);
    OrbitCamera orbit = FrameMesh(model.mesh, 0.5, static_cast<double>(kWidth) / kHeight);
    for (const double azimuth : {0.3, 2.2, 4.4}) {
      orbit.azimuth = azimuth;
      orbit.elevation = 0.4;
      const Camera camera = PinholeCamera(orbit, kWidth, kHeight);
      const Pose pose = CameraFromWorld(orbit);
      for (int terms = 0; terms <= model.terms; ++terms) {
        GlRenderOptions gl_options;
        gl_options.evaluation.terms = terms;
        RenderOptions options;
        options.evaluation.terms = terms;
        const Rendering expected = reference.Render(camera, pose, options, SilentProgress());
        const GlFramebuffer framebuffer(kWidth, kHeight, 1);
        framebuffer.Bind();
        gl.Draw(camera, pose, gl_options);
        // Full pixels alone: at silhouettes the two may differ by a pixel.
        Image mask(kWidth, kHeight, 1, PixelType::kUint8, ColorEncoding::kLinear);
        for (int y = 2; y < kHeight - 2; ++y) {
          for (int x = 2; x < kWidth - 2; ++x) {
            bool full = true;
            for (int i = 0; i < 9; ++i) {
              full = full && expected.coverage.At<uint8_t>(x + i % 3 - 1, y + i / 3 - 1) == 255;
            }
            mask.At<uint8_t>(x, y) = full ? 255 : 0;
          }
        }
        const ImageDifference difference = CompareImages(framebuffer.Read(), expected.color, mask);
        EXPECT_GT(difference.pixels, 4000);
        EXPECT_GE(difference.psnr_db, kMinPsnrDb) << terms << " terms, azimuth " << azimuth;
      }
    }
  }
  EglContext context_;
};

TEST_F(GlCompressedModel, CodebooksAreShownAsTheReferenceShowsThem) {
  const LightFieldModel model = Sharing(MakeSmoothRandomModel(1, DirectionMap::kHemiOctahedral));
  ASSERT_GT(model.mean_pages.size(), 1u);
  ExpectSamePictures(model);
}

TEST_F(GlCompressedModel, CoarserPatchesAreShownAsTheReferenceShowsThem) {
  const LightFieldModel model = Coarser(MakeSmoothRandomModel(4, DirectionMap::kHemiOctahedral));
  std::set<int> sizes;
  for (const auto& term : model.surface_placements) {
    for (const PatchPlacement& placement : term) sizes.insert(placement.edge_samples);
  }
  ASSERT_GT(sizes.size(), 2u);
  ExpectSamePictures(model);
}

TEST_F(GlCompressedModel, BlocksAreShownAsTheReferenceShowsThem) {
  const LightFieldModel model = MakeSmoothRandomModel(2, DirectionMap::kHemiOctahedral);
  ExpectSamePictures(InBlocks(model, BlockFormat::kBc1));
  ExpectSamePictures(InBlocks(model, BlockFormat::kBc4));
}

// What drivers without S3TC are given.
TEST_F(GlCompressedModel, DecodedBlocksShowTheSame) {
  const LightFieldModel model = MakeSmoothRandomModel(2, DirectionMap::kHemiOctahedral);
  ExpectSamePictures(InBlocks(model, BlockFormat::kBc1), BlockUse::kDecoded);
  ExpectSamePictures(InBlocks(model, BlockFormat::kBc4), BlockUse::kDecoded);
}

TEST_F(GlCompressedModel, CodebooksInBlocksToo) {
  const LightFieldModel model = Sharing(MakeSmoothRandomModel(3, DirectionMap::kOrthographic));
  ExpectSamePictures(InBlocks(model, BlockFormat::kBc4));
}

}  // namespace
}  // namespace lfm
