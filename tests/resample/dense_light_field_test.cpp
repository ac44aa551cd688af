// SPDX-License-Identifier: BSD-3-Clause
#include "resample/dense_light_field.h"

#include <gtest/gtest.h>

#include <Eigen/Core>

#include "core/atomic_file.h"
#include "core/error.h"
#include "resample/resample.h"
#include "test_scenes.h"

namespace lfm {
namespace {

LightField SmallField(const std::string& name) {
  const auto made = test::MakeCapture(
      test::Sphere({0, 0, 0}, 40, 4), test::TestCamera(160, 120, 280), test::PosesAround(8, 260),
      [](const Eigen::Vector3d& p) -> Eigen::Vector3d {
        return Eigen::Vector3d(0.5, 0.5, 0.5) + p / 150;
      },
      {0, 0, 0}, 1);
  const auto file = test::TestFolder(name) / "light_field.lfs";
  ResampleOptions options;
  options.view_grid = 5;
  Resample(made.capture, made.calib, test::Sphere({0, 0, 0}, 40, 4), test::Sphere({0, 0, 0}, 40, 1),
           made.Loader(), options, file, SilentProgress());
  return LightField::Open(file);
}

/// F = P W by matrices: P rows x views, W views x grid^2 scattered from the weights.
Eigen::MatrixXf ProductOf(const LightField& field, int triangle, int corner) {
  const TrianglePatch patch = field.Patch(triangle);
  const auto rows = static_cast<Eigen::Index>(3 * PatchSampleCount(patch.edge_samples));
  const auto views = static_cast<Eigen::Index>(patch.photos.size());
  const Eigen::Index entries = Eigen::Index{field.grid()} * field.grid();
  Eigen::MatrixXf p(rows, views), w = Eigen::MatrixXf::Zero(views, entries);
  for (Eigen::Index r = 0; r < rows; ++r) {
    for (Eigen::Index v = 0; v < views; ++v) {
      p(r, v) =
          static_cast<float>(patch.values[static_cast<size_t>(r * views + v)]) / LightField::kOne;
    }
  }
  LightField::WeightBuffer buffer;
  const ViewWeights weights = field.Weights(triangle, corner, buffer);
  for (size_t i = 0; i < weights.view.size(); ++i) {
    w(weights.view[i], static_cast<Eigen::Index>(i / 3)) += weights.weight[i];
  }
  return p * w;
}

TEST(DenseLightField, IsTheProductOfPatchAndWeights) {
  const LightField field = SmallField("dense");
  const auto file = test::TestFolder("dense_file") / "dense.bin";
  WriteDense(field, file, SilentProgress());
  int compared = 0;
  for (int t = 0; t < field.triangle_count(); t += 3) {
    for (int corner = 0; corner < 3; ++corner) {
      const std::vector<float> block = ReadDenseBlock(file, t, corner);
      const Eigen::MatrixXf product = ProductOf(field, t, corner);
      ASSERT_EQ(static_cast<Eigen::Index>(block.size()), product.size());
      for (Eigen::Index r = 0; r < product.rows(); ++r) {
        for (Eigen::Index q = 0; q < product.cols(); ++q) {
          EXPECT_NEAR(block[static_cast<size_t>(r * product.cols() + q)], product(r, q), 1e-6);
        }
      }
      compared += field.Patch(t).photos.empty() ? 0 : 1;
    }
  }
  EXPECT_GT(compared, 30);
}

TEST(DenseLightField, RefusesTruncatedAndForeignFiles) {
  const LightField field = SmallField("dense_bad");
  const auto file = test::TestFolder("dense_bad_file") / "dense.bin";
  WriteDense(field, file, SilentProgress());
  EXPECT_THROW(ReadDenseBlock(file, field.triangle_count(), 0), Error);
  EXPECT_THROW(ReadDenseBlock(file, 0, 3), Error);
  EXPECT_THROW(ReadDenseBlock(file, -1, 0), Error);
  const std::string whole = ReadFile(file);
  for (const size_t size : {size_t{0}, size_t{7}, size_t{23}, size_t{40}, whole.size() - 1}) {
    WriteFileAtomically(file, std::string_view(whole).substr(0, size));
    EXPECT_THROW(ReadDenseBlock(file, field.triangle_count() - 1, 2), Error) << size;
  }
  EXPECT_THROW(ReadDenseBlock(file.parent_path() / "missing", 0, 0), Error);
}

}  // namespace
}  // namespace lfm
