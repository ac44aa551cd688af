// SPDX-License-Identifier: BSD-3-Clause
// The parts that AFX files are made with: automatic frames, shared ranges, view maps on the disc.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "core/error.h"
#include "encode/afx.h"
#include "encode/afx_frames.h"
#include "encode/afx_ranges.h"
#include "encode/disc_views.h"
#include "encode/encode.h"
#include "encode/model_evaluation.h"
#include "resample/direction_map.h"
#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {
namespace {

TEST(AfxFrames, FollowTheAppendixWithItsErrataMended) {
  const TriangleMesh mesh = MakeSphere(1);
  const std::vector<Eigen::Matrix3d> frames = AutomaticAfxFrames(mesh);
  for (size_t v = 0; v < frames.size(); ++v) {
    const Eigen::Matrix3d& frame = frames[v];
    EXPECT_LT((frame.transpose() * frame - Eigen::Matrix3d::Identity()).norm(), 1e-12);
    EXPECT_NEAR(frame.determinant(), -1, 1e-12);
    // Step by step as it is printed.
    Eigen::Vector3d sum = Eigen::Vector3d::Zero(), first = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3i& t : mesh.triangles) {
      if (t[0] != static_cast<int>(v) && t[1] != static_cast<int>(v) &&
          t[2] != static_cast<int>(v)) {
        continue;
      }
      const Eigen::Vector3d e1 = mesh.vertices[t[0]] - mesh.vertices[t[1]],
                            e2 = mesh.vertices[t[1]] - mesh.vertices[t[2]];
      if (first.isZero(0)) first = e1;
      sum += e1.cross(e2);
    }
    const Eigen::Vector3d z = sum.normalized(), y = first.normalized().cross(z), x = z.cross(y);
    EXPECT_LT((frame.col(2) - z).norm(), 1e-12);
    EXPECT_LT((frame.col(1) * y.norm() - y).norm(), 1e-12);
    EXPECT_LT((frame.col(0) * x.norm() - x).norm(), 1e-12);
  }
}

TEST(AfxFrames, AreDefinedWhereTheAppendixIsNot) {
  TriangleMesh mesh;
  // Two triangles whose normals add up to (0, 0, 1), the first edge of the first one along it.
  mesh.vertices = {{0, 0, 1}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 5, 5}};
  mesh.triangles = {{0, 1, 2}, {2, 1, 0}, {1, 2, 3}};
  for (const Eigen::Matrix3d& frame : AutomaticAfxFrames(mesh)) {
    EXPECT_LT((frame.transpose() * frame - Eigen::Matrix3d::Identity()).norm(), 1e-12);
    EXPECT_NEAR(frame.determinant(), -1, 1e-12);
  }
}

// A file without a frame list is read with automatic frames: mirrored, so that the model's frames
// are right-handed and shows the same.
TEST(AfxFrames, StandInForFramesThatAreNotGiven) {
  const SyntheticLightField field = MakeLightField(
      MakeSphere(1), 8, 60, [](int) { return 4; }, GlossyAppearance);
  LightFieldModel model =
      Encode(field.Source(), {.terms = 2, .transport_db = 0}, SilentProgress()).model;
  // The model in automatic frames, their y turned to be right-handed.
  model.vertex_frames = AutomaticAfxFrames(model.mesh);
  for (Eigen::Matrix3d& frame : model.vertex_frames) frame.col(1) *= -1;
  const LightFieldModel form = AfxForm(model, {});
  const AfxFiles files = WriteAfxForm(form);
  const AfxPictureSource mirrored = [&](const std::string& name) -> std::string {
    for (const AfxFiles::Picture& picture : files.pictures) {
      if (picture.name == name) {
        return {reinterpret_cast<const char*>(picture.png.data()), picture.png.size()};
      }
    }
    throw Error(name);
  };
  std::string text = files.wrl;
  const size_t list = text.find("vertexFrameList", text.find("Transform {"));
  const size_t end = text.find("\n}", text.find("frame [", list)) + 2;
  text.erase(list, end - list);
  const LightFieldModel back = ReadAfxText(text, "model.wrl", mirrored);
  int compared = 0;
  for (size_t v = 0; v < form.vertex_frames.size(); ++v) {
    EXPECT_LT((back.vertex_frames[v] - form.vertex_frames[v]).norm(), 1e-5);
    if (form.vertex_terms[v] == 0) continue;
    ++compared;
    // The file's view maps were for right-handed frames: read for left-handed ones, their rows are
    // turned round.
    const auto a = form.ViewTile(0, static_cast<int>(v)), b = back.ViewTile(0, static_cast<int>(v));
    for (int y = 0; y < form.grid; ++y) {
      EXPECT_EQ(form.view_pages[0][a.page].At<uint8_t>(a.x + 1, a.y + y),
                back.view_pages[0][b.page].At<uint8_t>(b.x + 1, b.y + form.grid - 1 - y));
    }
  }
  EXPECT_GT(compared, 5);
}

TermExtents Term(float surface_low, float surface_high, float view_low, float view_high) {
  TermExtents term;
  term.surface = {surface_low, surface_high};
  term.view = {view_low, view_high};
  term.surface_norm2 = 10 * term.surface.max_abs() * term.surface.max_abs();
  term.view_norm2 = 30 * term.view.max_abs() * term.view.max_abs();
  term.surface_samples = 90;
  term.view_samples = 192;
  return term;
}

TEST(AfxRanges, HoldAllValuesOfTheirVertices) {
  const std::vector<TermExtents> terms = {Term(-1, 4, -0.5, 9),
                                          Term(-8, 1, -3, 0.1),
                                          Term(0, 0.01f, -0.02f, 0.5f),
                                          Term(0, 0, 0, 1),
                                          Term(-1e-6f, 2e-6f, -1e6f, 1e5f),
                                          Term(0, 0, 0, 0)};
  const auto [range, surface_scales] = ShareRange(terms);
  ASSERT_EQ(surface_scales.size(), terms.size());
  for (size_t i = 0; i < terms.size(); ++i) {
    const double scale = surface_scales[i];
    ASSERT_TRUE(std::isfinite(scale));
    ASSERT_NE(scale, 0);
    const double slack = 1e-5 * range.scale;
    for (const double value : {terms[i].surface.low * scale, terms[i].surface.high * scale,
                               terms[i].view.low / scale, terms[i].view.high / scale}) {
      EXPECT_GE(value, range.bias - slack);
      EXPECT_LE(value, range.bias + range.scale + slack);
    }
  }
  EXPECT_EQ(DecodeValue(range, ZeroCode(range)), 0);
  EXPECT_TRUE(ShareRange({}).surface_scales.empty());
}

TEST(AfxRanges, TurnsSignsSoThatLargeValuesArePositive) {
  const std::vector<TermExtents> terms = {Term(-8, 1, -8, 1), Term(-1, 8, -1, 8)};
  const SharedRange shared = ShareRange(terms);
  EXPECT_LT(shared.surface_scales[0], 0);
  EXPECT_GT(shared.surface_scales[1], 0);
  EXPECT_LT(shared.range.scale, 10);  // not from -8 to 8
}

// A map that is smooth in direction is the same on the disc; looked up at random directions.
class DiscViewsFrom : public ::testing::TestWithParam<DirectionMap> {};
INSTANTIATE_TEST_SUITE_P(Squares, DiscViewsFrom,
                         ::testing::Values(DirectionMap::kHemiOctahedral,
                                           DirectionMap::kHemiOctahedralSkirt));

TEST_P(DiscViewsFrom, KeepsSmoothMaps) {
  constexpr int kGrid = 16;
  const auto value = [](const Eigen::Vector3d& d) { return 0.4 + 0.3 * d.x() - 0.2 * d.y(); };
  std::vector<float> square;
  for (int channel = 0; channel < 3; ++channel) {
    for (int q = 0; q < kGrid * kGrid; ++q) {
      const auto d = GridDirection(GetParam(), kGrid, q);
      square.push_back(static_cast<float>(channel == 0 ? 0.7 : channel * value(d)));
    }
  }
  const std::vector<float> disc = DiscViews(kGrid, GetParam()).FromSquare(square);
  ASSERT_EQ(disc.size(), square.size());
  constexpr double kConstant_abs = 1e-5, kSmooth_abs = 0.02;
  for (int q = 0; q < kGrid * kGrid; ++q) {
    EXPECT_NEAR(disc[q], 0.7, kConstant_abs);
    const int x = q % kGrid, y = q / kGrid;
    const Eigen::Vector2d centre(x / (kGrid - 1.0) - 0.5, y / (kGrid - 1.0) - 0.5);
    if (centre.norm() > 0.48) continue;
    const auto d = GridDirection(DirectionMap::kOrthographic, kGrid, q);
    EXPECT_NEAR(disc[kGrid * kGrid + q], value(d), kSmooth_abs) << x << " " << y;
    EXPECT_NEAR(disc[2 * kGrid * kGrid + q], 2 * value(d), 2 * kSmooth_abs);
  }
}

}  // namespace
}  // namespace lfm::testing
