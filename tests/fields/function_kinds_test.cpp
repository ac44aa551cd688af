// SPDX-License-Identifier: BSD-3-Clause
#include "fields/function_kinds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"

namespace lfm {
namespace {

// Spirals of lights over the whole sphere.
std::vector<Eigen::Vector3d> Lights(int count) {
  std::vector<Eigen::Vector3d> lights;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count, angle = 2.399963 * i, r = std::sqrt(1 - z * z);
    lights.push_back({r * std::cos(angle), r * std::sin(angle), z});
  }
  return lights;
}

struct Surface {
  Eigen::Vector3d normal = {0, 0, 1};
  double diffuse = 0.5, gloss = 0, shininess = 40;
  Eigen::Vector3d blocked_side = {0, 0, 0};  // lights with l . this > 0.3 are blocked
};

Field FieldOf(const std::vector<Surface>& surfaces, int lights) {
  Field field;
  field.name = "made";
  field.points = static_cast<int64_t>(surfaces.size());
  field.directions = Lights(lights);
  field.functions = MakeFunctionRows(field.points, lights);
  const Eigen::Vector3d eye(0, 0, 1);
  for (int64_t r = 0; r < field.points; ++r) {
    const Surface& s = surfaces[r];
    const Eigen::Vector3d n = s.normal.normalized();
    const Eigen::Vector3d mirrored = 2 * n.dot(eye) * n - eye;
    for (int j = 0; j < lights; ++j) {
      const Eigen::Vector3d& l = field.directions[j];
      if (n.dot(l) <= 0 || l.dot(s.blocked_side) > 0.3) continue;
      field.functions.Row(r)[j] = static_cast<float>(
          s.diffuse * n.dot(l) + s.gloss * std::pow(std::max(0.0, mirrored.dot(l)), s.shininess));
    }
  }
  return field;
}

bool Has(const std::vector<int64_t>& rows, int64_t row) {
  return std::binary_search(rows.begin(), rows.end(), row);
}

TEST(FunctionKinds, TellsShadowsFromHighlights) {
  const Eigen::Vector3d tilted(0.4, 0.2, 1);
  const Field field = FieldOf({{{0, 0, 1}, 0.5, 0},
                               {tilted, 0.5, 0},
                               {tilted, 0.5, 1},
                               {{0, 0, 1}, 0.5, 0, 40, {1, 0, 0}},
                               {tilted, 0.4, 1, 40, {-1, 0, 0}},
                               {{0, 0, 1}, 0.0005, 0}},
                              253);
  const FunctionKinds kinds = SplitByKind(field);
  EXPECT_EQ(kinds.object, (std::vector<int64_t>{0, 1, 2, 3, 4}));
  EXPECT_EQ(kinds.unoccluded, (std::vector<int64_t>{0, 1, 2}));
  EXPECT_EQ(kinds.specular, (std::vector<int64_t>{2, 4}));
}

TEST(FunctionKinds, DoesNotDependOnTheScaleButForTheNoise) {
  for (float scale : {1e-20f, 1e20f}) {
    Field field = FieldOf({{{0.3, 0, 1}, 0.5, 0}, {{0, 0.3, 1}, 0.5, 1}}, 200);
    for (float& v : field.functions.values) v *= scale;
    FunctionKindOptions options;
    options.noise = 0;
    const FunctionKinds kinds = SplitByKind(field, options);
    EXPECT_EQ(kinds.unoccluded.size(), 2u) << scale;
    EXPECT_EQ(kinds.specular, (std::vector<int64_t>{1})) << scale;
  }
}

TEST(FunctionKinds, RowsThatTellNothingAreOfNeitherKind) {
  const FunctionKinds few = SplitByKind(FieldOf({{{0, 0, 1}, 0.5, 1}}, 3));
  EXPECT_TRUE(Has(few.object, 0));
  EXPECT_TRUE(few.unoccluded.empty());
  Field flat = FieldOf({{{0, 0, 1}, 0.5, 0}}, 50);
  for (Eigen::Vector3d& l : flat.directions) l = {0, 0, 1};
  EXPECT_TRUE(SplitByKind(flat).specular.empty());
  const FunctionKinds black = SplitByKind(FieldOf({{{0, 0, 1}, 0, 0}}, 50));
  EXPECT_TRUE(black.object.empty());
}

TEST(FunctionKinds, RefusesWhatDoesNotFit) {
  Field field = FieldOf({{{0, 0, 1}, 0.5, 1}}, 20);
  field.functions.Row(0)[3] = std::numeric_limits<float>::infinity();
  EXPECT_THROW(SplitByKind(field), Error);
  field = FieldOf({{{0, 0, 1}, 0.5, 1}}, 20);
  field.directions.pop_back();
  EXPECT_THROW(SplitByKind(field), Error);
}

}  // namespace
}  // namespace lfm
