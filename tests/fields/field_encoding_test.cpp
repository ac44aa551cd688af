// SPDX-License-Identifier: BSD-3-Clause
#include "fields/field_encoding.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/error.h"
#include "fields/model_methods.h"
#include "fields/relightable_file.h"

namespace lfm {
namespace {

// A picture of patches of a few normals, with shadows and noise; every other row of pixels black.
Field SmallField(int width, int height, int lights, int channels) {
  std::mt19937 random(9);
  std::uniform_real_distribution<float> uniform(0, 1);
  Field field;
  field.name = "small";
  field.width = width;
  field.height = height;
  field.points = static_cast<int64_t>(width) * height;
  field.channels = channels;
  for (int i = 0; i < lights; ++i) {
    const double z = 1 - (i + 0.5) / lights, r = std::sqrt(1 - z * z);
    field.directions.emplace_back(r * std::cos(2.4 * i), r * std::sin(2.4 * i), z);
  }
  field.functions = MakeFunctionRows(field.points * channels, lights);
  for (int64_t row = 0; row < field.functions.rows; ++row) {
    const int64_t point = row % field.points;
    if (point / width % 2 == 1) continue;
    const Eigen::Vector3d normal =
        Eigen::Vector3d(0.3 * static_cast<double>(point % 3) - 0.3, 0.2, 1).normalized();
    const float albedo = 0.2f + 0.8f * uniform(random);
    for (int j = 0; j < lights; ++j) {
      const double shading = std::max(0.0, normal.dot(field.directions[j]));
      field.functions.Row(row)[j] =
          uniform(random) < 0.1f ? 0 : albedo * static_cast<float>(shading);
    }
  }
  return field;
}

TEST(FieldEncoding, EveryMethodGivesTheFieldBackWithAllResiduals) {
  const Field field = SmallField(12, 10, 20, 3);
  for (FieldMethod method : {FieldMethod::kSparseResidual, FieldMethod::kPca}) {
    FieldEncodeOptions options;
    options.method = method;
    options.sparse.clusters = 4;
    options.sparse.terms = 2;
    options.sparse.residual_threshold = 1e-3;
    options.pca.energy_percent = 90;
    const FieldEncodeResult result = EncodeField(field, options, SilentProgress());
    CheckRelightable(result.model);
    EXPECT_EQ(result.figures["model_bytes"], EncodeRelightable(result.model).size());
    EXPECT_LT(result.figures["relative_error"].get<double>(), 1e-3);
    EXPECT_GT(result.figures["relative_error_without_residual"].get<double>(),
              result.figures["relative_error"].get<double>());
    const std::vector<LightMethod> methods = ModelMethods(result.model, "model", {0, 4, -1});
    ASSERT_EQ(methods.size(), 3u);
    EXPECT_EQ(methods[1].name, "model + 4 residuals");
    EXPECT_LT(methods[0].bytes, methods[1].bytes);
    EXPECT_LE(methods[1].bytes, methods[2].bytes);
    EXPECT_EQ(methods[2].bytes, static_cast<int64_t>(EncodeRelightable(result.model).size()));
    // Under a training light every row is within the threshold of what was measured.
    const std::vector<float> shown = methods[2].predict(field.directions[7]);
    ASSERT_EQ(static_cast<int64_t>(shown.size()), field.functions.rows);
    for (int64_t r = 0; r < field.functions.rows; ++r) {
      EXPECT_NEAR(shown[r], field.functions.Row(r)[7], 2.5e-3) << r;
    }
  }
}

TEST(FieldEncoding, HaarBasisShowsTheSameField) {
  const Field field = SmallField(8, 6, 13, 1);
  FieldEncodeOptions options;
  options.sparse.clusters = 2;
  options.sparse.terms = 2;
  options.sparse.residual_threshold = 1e-4;
  options.sparse.functions_basis = FunctionsBasis::kHaar;
  const FieldEncodeResult result = EncodeField(field, options, SilentProgress());
  EXPECT_FALSE(result.model.column_basis.IsIdentity());
  const LightMethod method = ModelMethods(result.model, "model", {-1}).front();
  for (int light : {0, 5, 12}) {
    const std::vector<float> shown = method.predict(field.directions[light]);
    for (int64_t r = 0; r < field.functions.rows; ++r) {
      EXPECT_NEAR(shown[r], field.functions.Row(r)[light], 3e-3) << r;
    }
  }
}

TEST(FieldEncoding, FewerResidualsAreTheLargest) {
  const Field field = SmallField(8, 6, 20, 1);
  FieldEncodeOptions options;
  options.sparse.clusters = 2;
  options.sparse.terms = 1;
  const RelightableModel model = EncodeField(field, options, SilentProgress()).model;
  const RelightableModel fewer = WithFewerResiduals(model, 3);
  CheckRelightable(fewer);
  for (int residuals : {0, 1, 3}) {
    EXPECT_EQ(RelativeError(model.model, field.functions.View(), residuals),
              RelativeError(fewer.model, field.functions.View(), residuals));
  }
  EXPECT_EQ(RelativeError(fewer.model, field.functions.View(), -1),
            RelativeError(model.model, field.functions.View(), 3));
}

TEST(FieldEncoding, OneLightOnePixelAndBlackFields) {
  for (FieldMethod method : {FieldMethod::kSparseResidual, FieldMethod::kPca}) {
    FieldEncodeOptions options;
    options.method = method;
    for (const Field& field : {SmallField(4, 3, 1, 3), SmallField(1, 1, 9, 1)}) {
      const FieldEncodeResult result = EncodeField(field, options, SilentProgress());
      EXPECT_LT(result.figures["relative_error"].get<double>(), 1e-3);
    }
    Field black = SmallField(4, 3, 5, 3);
    black.functions = MakeFunctionRows(black.functions.rows, 5);
    const FieldEncodeResult result = EncodeField(black, options, SilentProgress());
    EXPECT_EQ(result.figures["relative_error"], 0);
    for (float value : ModelMethods(result.model, "model", {-1})[0].predict({0, 0, 1})) {
      EXPECT_EQ(value, 0);
    }
  }
}

}  // namespace
}  // namespace lfm
