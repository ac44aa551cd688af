// SPDX-License-Identifier: BSD-3-Clause
#include "resample/resample_pictures.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "test_scenes.h"

namespace lfm {
namespace {

/// Two triangles: the first with `views` views whose samples tell view and place, the other unseen.
LightField MadeField(int views) {
  const auto file = test::TestFolder("pictures") / "light_field.lfs";
  LightFieldWriter::Header header;
  header.mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {5, 5, 5}};
  header.mesh.triangles = {{0, 1, 2}, {0, 3, 1}};
  header.vertex_frames = ComputeVertexFrames(header.mesh);
  header.grid = 2;
  LightFieldWriter::Triangle seen, unseen;
  seen.edge_samples = unseen.edge_samples = 3;
  for (int v = 0; v < views; ++v) {
    header.photo_ids.push_back(std::to_string(v));
    seen.photos.push_back(static_cast<uint16_t>(v));
  }
  for (int sample = 0; sample < 6; ++sample) {
    for (int c = 0; c < 3; ++c) {
      for (int v = 0; v < views; ++v) {
        const int level = c == 0 ? 40 * sample : c == 1 ? 30 * v : 0;
        seen.values.push_back(static_cast<uint16_t>(level * LightField::kOne / 255.0 + 0.5));
      }
    }
  }
  for (auto& weights : seen.weights)
    weights = {std::vector<uint16_t>(12, 0), std::vector<float>(12, 1.0F / 3),
               std::vector<uint8_t>(4, 1)};
  LightFieldWriter writer(file, header);
  writer.Write(seen);
  writer.Write(unseen);
  writer.Finish();
  return LightField::Open(file);
}

TEST(CoverageValues, AreMeanViewsOfTheRing) {
  EXPECT_EQ(CoverageValues(MadeField(5)), (std::vector<float>{2.5F, 2.5F, 5, 0, 0}));
}

TEST(PatchContactSheet, ShowsEverySampleOfEveryView) {
  const Image sheet = PatchContactSheet(MadeField(5), 0, 12);  // 4 pixels a sample, 3 x 2 tiles
  ASSERT_EQ(sheet.width(), 3 * 16 + 4);
  ASSERT_EQ(sheet.height(), 2 * 16 + 4);
  for (int v = 0; v < 5; ++v) {
    const int left = 4 + v % 3 * 16, top = 4 + v / 3 * 16;
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i + j < 3; ++i) {
        const int x = left + 4 * i + 1, y = top + 4 * j + 2;
        EXPECT_EQ(sheet.At<uint8_t>(x, y, 0), 40 * PatchSampleIndex(3, i, j));
        EXPECT_EQ(sheet.At<uint8_t>(x, y, 1), 30 * v);
      }
    }
    EXPECT_EQ(sheet.At<uint8_t>(left + 11, top + 11, 0), 96);  // outside the triangle
  }
}

TEST(PatchContactSheet, DefinesTheExtremes) {
  const LightField field = MadeField(1);
  const Image empty = PatchContactSheet(field, 1);
  for (size_t i = 0; i < empty.size(); ++i) ASSERT_EQ(empty.Data<uint8_t>()[i], 96);
  EXPECT_NO_THROW(PatchContactSheet(field, 0, 1));
  EXPECT_THROW(PatchContactSheet(field, 2), Error);
  EXPECT_THROW(PatchContactSheet(field, -1), Error);
  EXPECT_THROW(PatchContactSheet(field, 0, 0), Error);
}

}  // namespace
}  // namespace lfm
