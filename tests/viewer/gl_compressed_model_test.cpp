// SPDX-License-Identifier: BSD-3-Clause
// Models with codebooks and with pages in blocks look in OpenGL as in the reference renderer.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "core/image_metrics.h"
#include "encode/gutters.h"
#include "encode/map_coarsening.h"
#include "encode/model_layout.h"
#include "encode/patch_resolution.h"
#include "encode/view_resolution.h"
#include "synthetic_model.h"
#include "viewer/egl_context.h"
#include "viewer/gl_framebuffer.h"
#include "viewer/gl_renderer.h"
#include "viewer/orbit_camera.h"
#include "viewer/reference_renderer.h"

namespace lfm {
namespace {

constexpr double kMinPsnrDb = 45;
constexpr int kWidth = 200, kHeight = 160;

/// Pages whose sides are whole blocks.
std::vector<Image> Padded(const std::vector<Image>& pages) {
  std::vector<Image> padded;
  for (const Image& page : pages) {
    Image larger((page.width() + 3) / 4 * 4, (page.height() + 3) / 4 * 4, 3, PixelType::kUint8,
                 ColorEncoding::kSrgb);
    for (int y = 0; y < larger.height(); ++y) {
      for (int x = 0; x < larger.width(); ++x) {
        std::copy_n(
            &page.At<uint8_t>(std::min(x, page.width() - 1), std::min(y, page.height() - 1)), 3,
            &larger.At<uint8_t>(x, y));
      }
    }
    padded.push_back(std::move(larger));
  }
  return padded;
}

std::vector<BlockPage> Coded(std::vector<Image>& pages, BlockFormat format) {
  std::vector<BlockPage> blocks;
  for (Image& page : pages) {
    blocks.push_back(EncodePage(page, format, {}, BlockQuality::kFast));
    page = DecodePage(blocks.back());
  }
  return blocks;
}

LightFieldModel InBlocks(LightFieldModel model, BlockFormat surface_format) {
  model.mean_pages = Padded(model.mean_pages);
  model.blocks.mean = Coded(model.mean_pages, BlockFormat::kBc1);
  for (int k = 0; k < model.terms; ++k) {
    model.surface_pages[k] = Padded(model.surface_pages[k]);
    model.view_pages[k] = Padded(model.view_pages[k]);
    model.blocks.surface.push_back(Coded(model.surface_pages[k], surface_format));
    model.blocks.view.push_back(Coded(model.view_pages[k], BlockFormat::kBc1));
  }
  return model;
}

/// Triangles and vertices show each other's maps, another's in each term.
LightFieldModel Sharing(LightFieldModel model) {
  std::mt19937 random(7);
  const int triangles = static_cast<int>(model.placements.size());
  const int vertices = static_cast<int>(model.vertex_terms.size());
  for (int k = 0; k < model.terms; ++k) {
    auto& placements = model.surface_placements.emplace_back(model.placements);
    for (int t = 0; t < triangles; ++t) {
      const int other = static_cast<int>(random() % triangles);
      if (model.TriangleTerms(other) > k) placements[t] = model.placements[other];
    }
    std::vector<int>& codes = model.view_codes.emplace_back(model.view_slots);
    for (int v = 0; v < vertices; ++v) {
      const int other = static_cast<int>(random() % vertices);
      if (model.vertex_terms[other] > k) codes[v] = model.view_slots[other];
    }
  }
  return model;
}

/// Each triangle keeps every sample, or fewer, of its mean view and of each term by itself; each
/// vertex shows its view map, of its grid or the first texels of it as one of half or a quarter.
LightFieldModel Coarser(const LightFieldModel& model) {
  std::mt19937 random(9);
  MapSelection maps{model.vertex_terms, std::vector<std::vector<uint8_t>>(model.placements.size()),
                    std::vector<std::vector<uint8_t>>(model.vertex_terms.size())};
  std::vector<std::vector<uint8_t>>& levels = maps.levels;
  for (size_t v = 0; v < model.vertex_terms.size(); ++v) {
    for (int k = 0; k < model.vertex_terms[v]; ++k) {
      maps.view_levels[v].push_back(
          static_cast<uint8_t>(random() % ViewGridLevels(model.grid).size()));
    }
  }
  const auto level = [&](int t) {
    const size_t count = EdgeSampleLevels(model.placements[t].edge_samples).size();
    return static_cast<uint8_t>(random() % count);
  };
  for (int t = 0; t < static_cast<int>(levels.size()); ++t) {
    for (int k = 0; k <= model.TriangleTerms(t); ++k) levels[t].push_back(level(t));
  }
  LightFieldModel coarse = LayOutCoarsened(model, maps, 512);
  for (int v = 0; v < static_cast<int>(model.vertex_terms.size()); ++v) {
    for (int k = 0; k < model.vertex_terms[v]; ++k) {
      const auto from = model.ViewTile(k, v), to = coarse.ViewTile(k, v);
      for (int y = 0; y < to.grid; ++y) {
        std::copy_n(&model.view_pages[k][from.page].At<uint8_t>(from.x, from.y + y), 3 * to.grid,
                    &coarse.view_pages[k][to.page].At<uint8_t>(to.x, to.y + y));
      }
    }
  }
  const auto copy = [](const Image& from_page, const PatchPlacement& from, Image& to_page,
                       const PatchPlacement& to) {
    for (int c = 0; c < 3; ++c) {
      const std::vector<uint8_t> codes = ReadPatch(from_page, from, c, 1);
      const std::vector<uint8_t> kept =
          SubsamplePatch(std::span<const uint8_t>(codes), from.edge_samples, to.edge_samples);
      WritePatch(to_page, to, kept.data(), c, 1);
    }
    CompletePatch(to_page, to);
  };
  for (int t = 0; t < static_cast<int>(levels.size()); ++t) {
    const PatchPlacement& from = model.placements[t];
    const PatchPlacement& mean = coarse.placements[t];
    copy(model.mean_pages[from.page], from, coarse.mean_pages[mean.page], mean);
    for (int k = 0; k < model.TriangleTerms(t); ++k) {
      const PatchPlacement& to = coarse.SurfacePlacement(k, t);
      copy(model.surface_pages[k][from.page], from, coarse.surface_pages[k][to.page], to);
    }
  }
  return coarse;
}

class GlCompressedModel : public testing::Test {
 protected:
  void ExpectSamePictures(const LightFieldModel& model) {
    const GlRenderer gl(model);
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

TEST_F(GlCompressedModel, CodebooksInBlocksToo) {
  const LightFieldModel model = Sharing(MakeSmoothRandomModel(3, DirectionMap::kOrthographic));
  ExpectSamePictures(InBlocks(model, BlockFormat::kBc4));
}

}  // namespace
}  // namespace lfm
