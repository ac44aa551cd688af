// SPDX-License-Identifier: BSD-3-Clause
#include "fields/analysis.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/error.h"
#include "core/parallel.h"

namespace lfm {
namespace {

Field Picture(int side, int columns, const std::function<float(int x, int y, int column)>& value) {
  Field field;
  field.name = "test";
  field.width = field.height = side;
  field.points = int64_t{side} * side;
  field.functions = MakeFunctionRows(field.points, columns);
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      for (int c = 0; c < columns; ++c) field.functions.Row(y * side + x)[c] = value(x, y, c);
    }
  }
  return field;
}

AnalysisOptions Small() {
  AnalysisOptions options;
  options.centers = 1;
  options.min_area = 8;
  options.max_area = 256;
  options.global_rows = 200;
  options.largest_block = 4;
  return options;
}

// Narrow bumps that move with x alone: as many as columns of pixels, so the square root of the
// area. With both, every pixel is its own.
TEST(Analysis, SlopesOfOneAndTwoDirections) {
  const auto bump = [](double at) { return static_cast<float>(std::abs(at) < 0.5); };
  const std::vector<int64_t> middle = {12 * 24 + 12};
  const Field edges = Picture(24, 24, [&](int x, int, int c) { return bump(x - c); });
  AnalysisOptions options = Small();
  options.shape = PatchShape::kSquare;
  const AnalysisResult one = AnalyzeField(edges, {}, middle, options, SilentProgress());
  ASSERT_TRUE(one.slope);
  EXPECT_NEAR(*one.slope, 0.5, 0.02);
  EXPECT_EQ(one.global_terms, 24);
  const Field points = Picture(24, 576, [&](int x, int y, int c) { return bump(24 * y + x - c); });
  const AnalysisResult two = AnalyzeField(points, {}, middle, options, SilentProgress());
  EXPECT_NEAR(*two.slope, 1, 0.02);
  for (size_t i = 0; i < two.curves[0].areas.size(); ++i) {
    EXPECT_EQ(two.curves[0].dimensions[i], two.curves[0].areas[i]);
  }
}

TEST(Analysis, EqualRowsHaveOneDimension) {
  const Field field = Picture(20, 9, [](int, int, int c) { return 1.0f + static_cast<float>(c); });
  const AnalysisResult result = AnalyzeField(field, {}, {}, Small(), SilentProgress());
  ASSERT_EQ(result.curves.size(), 1u);
  EXPECT_NEAR(*result.slope, 0, 1e-12);
  EXPECT_FALSE(result.slope_half_width);
  EXPECT_EQ(result.global_terms, 1);
  ASSERT_EQ(result.predictions.size(), 2u);
  EXPECT_TRUE(std::isinf(result.predictions[0].pixels));
  // One term a block: n (p + N) / p = 1 + 1 / p.
  ASSERT_EQ(result.block_costs.size(), 3u);
  EXPECT_NEAR(result.block_costs[0].cost.PerPixel(), 2, 1e-12);
  EXPECT_NEAR(result.block_costs[2].cost.PerPixel(), 1 + 1.0 / 16, 1e-12);
  const nlohmann::json json = AnalysisToJson(result);
  EXPECT_FALSE(json["predictions"][0].contains("pixels"));  // JSON has no infinity
  EXPECT_EQ(json["curves"][0]["dimensions"].size(), result.curves[0].areas.size());
  EXPECT_NE(AnalysisToSvg(result).find("</svg>"), std::string::npos);
  EXPECT_NE(BlockCostsToSvg(result).find("local to pixels"), std::string::npos);
  EXPECT_GE(Findings(result).size(), 5u);
}

TEST(Analysis, WhatSeesTheLightOrNothingIsNotOccupied) {
  Field field = Picture(4, 6, [](int x, int y, int c) {
    if (y == 0) return x == c ? 1.0f : 0.0f;  // one texel of light, as it is
    if (y == 1) return 0.0f;
    return 0.1f * static_cast<float>(c + 1);
  });
  field.kind = FieldColumns::kCubeTexels;
  const OccupiedField transport = GrayOfField(field, 1e-3);
  for (int i = 0; i < 16; ++i) EXPECT_EQ(transport.occupied[i], i >= 8) << i;
  field.kind = FieldColumns::kLights;  // a picture lit from one side may look like that
  EXPECT_EQ(GrayOfField(field, 1e-3).occupied[1], 1);
  field.mask.assign(16, 1);
  field.mask[15] = 0;
  EXPECT_EQ(GrayOfField(field, 1e-3).occupied[15], 0);
}

TEST(Analysis, DarkPointsAreBackground) {
  const Field field = Picture(4, 6, [](int x, int, int) { return x < 2 ? 1.0f : 0.01f; });
  const OccupiedField strict = GrayOfField(field, 1e-3), lenient = GrayOfField(field, 1e-5);
  EXPECT_EQ(strict.occupied[0], 1);
  EXPECT_EQ(strict.occupied[3], 0);
  EXPECT_EQ(lenient.occupied[3], 1);
}

TEST(Analysis, ChannelsAreAveraged) {
  Field field = Picture(2, 3, [](int, int, int) { return 1.0f; });
  field.channels = 3;
  field.functions = MakeFunctionRows(12, 3);
  for (int c = 0; c < 3; ++c) {
    for (int point = 0; point < 4; ++point) {
      field.functions.Row(field.RowOf(point, c))[1] = static_cast<float>(c + point);
    }
  }
  EXPECT_NEAR(GrayOfField(field, 0).rows.Row(3)[1], 4, 1e-6);
}

TEST(Analysis, ResultsDoNotDependOnThreads) {
  const Field field = Picture(24, 40, [](int x, int y, int c) {
    return static_cast<float>(1 + std::sin(0.3 * x * c) * std::cos(0.2 * y * c));
  });
  const auto text = [&] {
    return AnalysisToJson(AnalyzeField(field, {}, {}, Small(), SilentProgress())).dump();
  };
  SetThreadCount(1);
  const std::string one = text();
  SetThreadCount(3);
  EXPECT_EQ(text(), one);
  SetThreadCount(0);
}

TEST(Analysis, Extremes) {
  const Field black = Picture(8, 4, [](int, int, int) { return 0.0f; });
  const AnalysisResult nothing = AnalyzeField(black, {}, {}, Small(), SilentProgress());
  EXPECT_EQ(nothing.occupied, 0);
  EXPECT_TRUE(nothing.curves.empty());
  EXPECT_EQ(nothing.global_terms, 0);
  EXPECT_FALSE(nothing.slope);
  EXPECT_NE(AnalysisToSvg(nothing).find("</svg>"), std::string::npos);
  EXPECT_FALSE(Findings(nothing).empty());

  const Field pixel = Picture(1, 1, [](int, int, int) { return 2.0f; });
  const AnalysisResult small = AnalyzeField(pixel, {}, {}, Small(), SilentProgress());
  ASSERT_EQ(small.curves.size(), 1u);
  EXPECT_TRUE(small.curves[0].areas.empty());
  EXPECT_EQ(small.global_terms, 1);

  const float infinity = std::numeric_limits<float>::infinity();
  const Field broken = Picture(2, 2, [&](int, int, int) { return infinity; });
  EXPECT_THROW(AnalyzeField(broken, {}, {}, Small(), SilentProgress()), Error);
  AnalysisOptions reversed = Small();
  reversed.max_area = 4;
  EXPECT_THROW(AnalyzeField(pixel, {}, {}, reversed, SilentProgress()), Error);
  EXPECT_THROW(AnalyzeField(black, {}, {3}, Small(), SilentProgress()), Error);
  Field vertices;
  vertices.name = "mesh";
  vertices.points = 1;
  vertices.positions = {{0, 0, 0}};
  vertices.functions = MakeFunctionRows(1, 2);
  AnalysisOptions along_edges = Small();
  along_edges.distance = VertexDistance::kEdges;
  EXPECT_THROW(AnalyzeField(vertices, {}, {}, along_edges, SilentProgress()), Error);
}

}  // namespace
}  // namespace lfm
