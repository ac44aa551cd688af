// SPDX-License-Identifier: BSD-3-Clause
#include "fields/heldout_lights.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/image_metrics.h"

namespace lfm {
namespace {

std::vector<Eigen::Vector3d> Dome(int count, double turn) {
  std::vector<Eigen::Vector3d> directions;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (i + 0.5) / count, r = std::sqrt(1 - z * z);
    directions.emplace_back(r * std::cos(2.4 * i + turn), r * std::sin(2.4 * i + turn), z);
  }
  return directions;
}

// A matte bump: n . l, black where that is negative; the first pixel is always black.
Field Bump(const std::vector<Eigen::Vector3d>& lights, float scale = 0.8f) {
  Field field;
  field.name = "bump";
  field.width = 6;
  field.height = 4;
  field.points = 24;
  field.channels = 3;
  field.directions = lights;
  field.functions = MakeFunctionRows(72, static_cast<int>(lights.size()));
  const float color[3] = {1, 0.7f, 0.4f};
  for (int point = 1; point < 24; ++point) {
    const Eigen::Vector3d normal =
        Eigen::Vector3d(0.2 * (point % 6) - 0.5, 0.2 * (point / 6) - 0.3, 1).normalized();
    for (int c = 0; c < 3; ++c) {
      for (size_t j = 0; j < lights.size(); ++j) {
        field.functions.Row(field.RowOf(point, c))[j] =
            scale * color[c] * static_cast<float>(std::max(0.0, normal.dot(lights[j])));
      }
    }
  }
  return field;
}

std::vector<float> Column(const Field& field, int column) {
  std::vector<float> values;
  for (int64_t r = 0; r < field.functions.rows; ++r) {
    values.push_back(field.functions.Row(r)[column]);
  }
  return values;
}

TEST(HeldoutLights, FiguresAreThoseOfTheirDefinitions) {
  const Field field = Bump(Dome(2, 0));
  const Image mask = ObjectMask(field, 1);
  int column = 0;
  const LightMethod exact{"exact", "a", 7,
                          [&](const Eigen::Vector3d&) { return Column(field, column++); }};
  // Half of the light everywhere.
  int half_column = 0;
  const LightMethod half{"half", "a", 8, [&](const Eigen::Vector3d&) {
                           std::vector<float> values = Column(field, half_column++);
                           for (float& v : values) v *= 0.5f;
                           return values;
                         }};
  const LightScores scores = ScoreLightMethods(field, mask, 1, {exact, half}, SilentProgress());
  EXPECT_EQ(scores.lights, 2);
  EXPECT_EQ(scores.pixels, 23);
  EXPECT_EQ(scores.methods[0].psnr_db, 99);
  EXPECT_EQ(scores.methods[0].relative_error, 0);
  EXPECT_EQ(scores.methods[0].bytes, 7);
  EXPECT_NEAR(scores.methods[1].relative_error, 0.25, 1e-6);
  double mse = 0;
  for (int light = 0; light < 2; ++light) {
    std::vector<float> values = Column(field, light);
    const Image truth = PictureOfRows(field, values, 1);
    for (float& v : values) v *= 0.5f;
    const ImageDifference difference = CompareImages(PictureOfRows(field, values, 1), truth, mask);
    mse += difference.mse / 2;
    EXPECT_DOUBLE_EQ(scores.methods[1].light_psnr_db[light], difference.psnr_db);
  }
  EXPECT_NEAR(scores.methods[1].psnr_db, PsnrFromMse(mse), 1e-9);
  const nlohmann::json json = LightScoresToJson(scores);
  EXPECT_EQ(json["methods"][1]["name"], "half");
  EXPECT_NE(LightFiguresToTable(json).find("half"), std::string::npos);
}

TEST(HeldoutLights, ClassicFitsAndPicturesPredictAMatteBump) {
  const Field train = Bump(Dome(60, 0)), held_out = Bump(Dome(9, 1));
  const ClassicFits fits = FitClassics(train, DomeFrame(train.directions));
  EXPECT_EQ(fits.names,
            (std::vector<std::string>{"PTM, luminance", "PTM", "HSH 4", "HSH 9", "HSH 16"}));
  std::vector<LightMethod> methods = ClassicMethods(fits, train);
  methods.push_back(NearestPicture(train));
  methods.push_back(InterpolatedPictures(train));
  EXPECT_EQ(methods[1].bytes, 72 * 6 + 6 * 8);
  EXPECT_EQ(methods[0].bytes, 24 * 9 + 6 * 8);
  EXPECT_EQ(methods[6].bytes, 72 * 60);
  const LightScores scores =
      ScoreLightMethods(held_out, ObjectMask(train, 1), 1, methods, SilentProgress());
  for (const LightMethodScore& score : scores.methods) {
    EXPECT_GT(score.psnr_db, 20) << score.name;
    EXPECT_LT(score.relative_error, 0.05) << score.name;
  }
  // More functions fit better, and neighbours interpolate better than the nearest alone.
  EXPECT_GT(scores.methods[4].psnr_db, scores.methods[3].psnr_db);
  EXPECT_GT(scores.methods[3].psnr_db, scores.methods[2].psnr_db);
  EXPECT_GT(scores.methods[6].psnr_db, scores.methods[5].psnr_db + 2);
}

TEST(HeldoutLights, MaskIsWhatLightReachesOrTheFieldsOwn) {
  Field field = Bump(Dome(5, 0));
  Image mask = ObjectMask(field, 1);
  EXPECT_EQ(mask.At<uint8_t>(0, 0), 0);
  EXPECT_EQ(mask.At<uint8_t>(1, 0), 255);
  field.mask.assign(24, 0);
  field.mask[0] = 1;
  mask = ObjectMask(field, 1);
  EXPECT_EQ(mask.At<uint8_t>(0, 0), 255);
  EXPECT_EQ(mask.At<uint8_t>(1, 0), 0);
}

TEST(HeldoutLights, WhiteFollowsValuesOfAnotherOrder) {
  EXPECT_EQ(DisplayWhite(Bump(Dome(20, 0))), 1);
  EXPECT_NEAR(DisplayWhite(Bump(Dome(20, 0), 800)), 800, 50);
  EXPECT_NEAR(DisplayWhite(Bump(Dome(20, 0), 1e-5f)), 1e-5, 1e-6);
  EXPECT_EQ(DisplayWhite(Bump(Dome(20, 0), 0)), 1);
}

TEST(HeldoutLights, BlackFieldOneLightAndNothingHeldOut) {
  const Field black = Bump(Dome(1, 0), 0);
  const ClassicFits fits = FitClassics(black, {});
  const std::vector<LightMethod> methods = ClassicMethods(fits, black);
  const LightScores scores = ScoreLightMethods(black, ObjectMask(black, DisplayWhite(black)), 1,
                                               methods, SilentProgress());
  EXPECT_EQ(scores.pixels, 24);  // without an object all pixels count
  for (const LightMethodScore& score : scores.methods) {
    EXPECT_EQ(score.psnr_db, 99) << score.name;
    EXPECT_EQ(score.relative_error, 0);
  }
  Field nothing = black;
  nothing.functions = {};
  nothing.directions.clear();
  const LightScores none =
      ScoreLightMethods(nothing, ObjectMask(black, 1), 1, methods, SilentProgress());
  EXPECT_EQ(none.lights, 0);
  EXPECT_FALSE(LightScoresToJson(none)["methods"][0].contains("psnr_db"));
  EXPECT_NE(LightFiguresToTable(LightScoresToJson(none)).find("PTM"), std::string::npos);
}

TEST(HeldoutLights, RefusesWhatDoesNotFit) {
  const Field field = Bump(Dome(2, 0));
  const LightMethod wrong{"wrong", "a", 0,
                          [](const Eigen::Vector3d&) { return std::vector<float>(5); }};
  EXPECT_THROW(ScoreLightMethods(field, ObjectMask(field, 1), 1, {wrong}, SilentProgress()), Error);
  Field vertices = field;
  vertices.width = vertices.height = 0;
  EXPECT_THROW(ObjectMask(vertices, 1), Error);
}

}  // namespace
}  // namespace lfm
