// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/overlay_colors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "core/error.h"
#include "encode/guessed_directions.h"
#include "resample/direction_map.h"
#include "synthetic_model.h"

namespace lfm {
namespace {

constexpr float kColor_abs = 1e-6f;
constexpr int kTerms = 3, kGrid = 17;
const Eigen::Vector3d kCenter(10, -20, 80);
constexpr double kRadius = 60;

/// A sphere with 42 vertices and 80 triangles. Its normals lean, so that they are not those of its
/// triangles.
LightFieldModel SmallModel(DirectionMap map = DirectionMap::kHemiOctahedral) {
  TriangleMesh mesh = MakeSphere(kRadius, kCenter, 1);
  for (Eigen::Vector3d& normal : mesh.normals) {
    normal = (normal + Eigen::Vector3d(0.3, 0.1, -0.2)).normalized();
  }
  ModelRecipe recipe;
  recipe.terms = kTerms;
  recipe.grid = kGrid;
  recipe.direction_map = map;
  recipe.mean = [](const Eigen::Vector3d&) { return Eigen::Vector3d(0.2, 0.4, 0.6); };
  recipe.surface = [](int, const Eigen::Vector3d&) { return 0.5; };
  recipe.view = [](int, int, const Eigen::Vector2d&) { return Eigen::Vector3d(0, 0, 0); };
  recipe.vertex_terms = [](int vertex) { return vertex % (kTerms + 1); };
  return MakeModel(mesh, recipe);
}

double Luminance(const Eigen::Vector3f& color) {
  return 0.2126 * color.x() + 0.7152 * color.y() + 0.0722 * color.z();
}

/// The one colour that all corners at the vertex have.
Eigen::Vector3f ColorOfVertex(const LightFieldModel& model, const OverlayColors& colors,
                              int vertex) {
  std::optional<Eigen::Vector3f> found;
  for (size_t t = 0; t < model.mesh.triangles.size(); ++t) {
    for (int c = 0; c < 3; ++c) {
      if (model.mesh.triangles[t][c] != vertex) continue;
      const Eigen::Vector3f& color = colors.corners[3 * t + c];
      if (!found) found = color;
      EXPECT_EQ(color, *found) << vertex;
    }
  }
  EXPECT_TRUE(found) << vertex;
  return found.value_or(Eigen::Vector3f::Zero());
}

/// The number that a legend's entry begins with.
int NumberOf(const LegendEntry& entry) { return std::stoi(entry.text); }

std::map<int, Eigen::Vector3f> LegendByNumber(const OverlayColors& colors) {
  std::map<int, Eigen::Vector3f> legend;
  for (const LegendEntry& entry : colors.legend) {
    EXPECT_TRUE(legend.emplace(NumberOf(entry), entry.color).second) << entry.text;
  }
  return legend;
}

void ExpectGray(const LightFieldModel& model, const OverlayColors& colors) {
  ASSERT_EQ(colors.corners.size(), 3 * model.mesh.triangles.size());
  ASSERT_EQ(colors.legend.size(), 1u);
  EXPECT_FALSE(colors.legend[0].text.empty());
  for (const Eigen::Vector3f& color : colors.corners) {
    EXPECT_EQ(color, colors.legend[0].color);
    EXPECT_EQ(color.x(), color.y());
    EXPECT_EQ(color.x(), color.z());
    EXPECT_GT(color.x(), 0.2f);
    EXPECT_LT(color.x(), 0.8f);
  }
}

/// Counts of the vertices as colours; equal ones equal, different ones different, and the legend
/// names those that are there and no others.
void ExpectCountColors(const LightFieldModel& model, const std::vector<int>& counts,
                       const OverlayColors& colors) {
  ASSERT_EQ(colors.corners.size(), 3 * model.mesh.triangles.size());
  std::map<int, Eigen::Vector3f> color_of;
  for (size_t v = 0; v < counts.size(); ++v) {
    const Eigen::Vector3f color = ColorOfVertex(model, colors, static_cast<int>(v));
    EXPECT_EQ(color, color_of.emplace(counts[v], color).first->second) << counts[v];
  }
  for (auto a = color_of.begin(); a != color_of.end(); ++a) {
    EXPECT_GE(a->second.minCoeff(), 0);
    EXPECT_LE(a->second.maxCoeff(), 1);
    for (auto b = std::next(a); b != color_of.end(); ++b) {
      EXPECT_GT((a->second - b->second).norm(), 0.01f) << a->first << " and " << b->first;
      if (a->first == 0) continue;
      EXPECT_LT(Luminance(a->second), Luminance(b->second)) << b->first;
    }
  }
  const std::map<int, Eigen::Vector3f> legend = LegendByNumber(colors);
  for (const auto& [count, color] : legend) {
    ASSERT_TRUE(color_of.contains(count)) << count;
    EXPECT_EQ(color, color_of.at(count)) << count;
  }
  EXPECT_TRUE(legend.contains(color_of.begin()->first));
  EXPECT_TRUE(legend.contains(color_of.rbegin()->first));
}

TEST(OverlayColors, NormalsAreThoseOfTheVertexFrames) {
  const LightFieldModel model = SmallModel();
  const OverlayColors colors = ColorsOf(Overlay::kNormals, model, {});
  ASSERT_EQ(colors.corners.size(), 3 * model.mesh.triangles.size());
  for (size_t t = 0; t < model.mesh.triangles.size(); ++t) {
    for (int c = 0; c < 3; ++c) {
      const Eigen::Vector3d normal = model.mesh.normals[model.mesh.triangles[t][c]];
      const Eigen::Vector3f expected = ((normal.array() + 1) / 2).matrix().cast<float>();
      EXPECT_LT((colors.corners[3 * t + c] - expected).norm(), kColor_abs) << t;
    }
  }
  std::map<std::string, Eigen::Vector3f> legend;
  for (const LegendEntry& entry : colors.legend) legend[entry.text] = entry.color;
  EXPECT_EQ(legend.size(), 3u);
  EXPECT_EQ(legend["+x"], Eigen::Vector3f(1, 0.5f, 0.5f));
  EXPECT_EQ(legend["+y"], Eigen::Vector3f(0.5f, 1, 0.5f));
  EXPECT_EQ(legend["+z"], Eigen::Vector3f(0.5f, 0.5f, 1));
}

TEST(OverlayColors, PhotographsAreCountedFromDarkBlueOverGreenToYellow) {
  const LightFieldModel model = SmallModel();
  OverlayData data;
  for (size_t v = 0; v < model.mesh.vertices.size(); ++v) {
    data.photographs.push_back(static_cast<int>(v * 5 % 6));
  }
  const OverlayColors colors = ColorsOf(Overlay::kPhotographs, model, data);
  ExpectCountColors(model, data.photographs, colors);
  std::map<int, Eigen::Vector3f> legend = LegendByNumber(colors);
  EXPECT_EQ(legend.size(), 6u) << "few: each has its entry";
  for (const LegendEntry& entry : colors.legend) {
    EXPECT_NE(entry.text.find("photograph"), std::string::npos) << entry.text;
  }
  const Eigen::Vector3f zero = legend[0], least = legend[1], middle = legend[3], most = legend[5];
  EXPECT_GT(zero.x(), 3 * std::max(zero.y(), zero.z())) << "dark red";
  EXPECT_LT(Luminance(zero), 0.25);
  EXPECT_EQ(least.maxCoeff(), least.z()) << "dark blue";
  EXPECT_LT(Luminance(least), 0.25);
  EXPECT_EQ(middle.maxCoeff(), middle.y()) << "green";
  EXPECT_GT(std::min(most.x(), most.y()), 0.8f) << "yellow";
  EXPECT_LT(most.z(), 0.3f);
}

TEST(OverlayColors, TheLegendNamesWhatIsThere) {
  const LightFieldModel model = SmallModel();
  OverlayData data;
  data.photographs.assign(model.mesh.vertices.size(), 7);
  OverlayColors colors = ColorsOf(Overlay::kPhotographs, model, data);
  ExpectCountColors(model, data.photographs, colors);
  EXPECT_EQ(colors.legend.size(), 1u) << "no zero, and seven once";

  std::fill(data.photographs.begin(), data.photographs.end(), 0);
  colors = ColorsOf(Overlay::kPhotographs, model, data);
  ExpectCountColors(model, data.photographs, colors);
  ASSERT_EQ(colors.legend.size(), 1u);
  EXPECT_EQ(NumberOf(colors.legend[0]), 0);

  // More than a legend can list: the least and the most, and some between.
  for (size_t v = 0; v < data.photographs.size(); ++v) {
    data.photographs[v] = static_cast<int>(3 + 2 * v);
  }
  colors = ColorsOf(Overlay::kPhotographs, model, data);
  ExpectCountColors(model, data.photographs, colors);
  EXPECT_GE(colors.legend.size(), 4u);
  EXPECT_LE(colors.legend.size(), 8u);
}

TEST(OverlayColors, PhotographsAreGrayWhereNobodyCounted) {
  const LightFieldModel model = SmallModel();
  ExpectGray(model, ColorsOf(Overlay::kPhotographs, model, {}));
  OverlayData other_mesh;
  other_mesh.photographs.assign(model.mesh.vertices.size() - 1, 3);
  ExpectGray(model, ColorsOf(Overlay::kPhotographs, model, other_mesh));
}

TEST(OverlayColors, TermsAreThoseOfTheVertices) {
  const LightFieldModel model = SmallModel();
  const OverlayColors colors = ColorsOf(Overlay::kTerms, model, {});
  ExpectCountColors(model, model.vertex_terms, colors);
  EXPECT_EQ(colors.legend.size(), 1u + kTerms) << "0 to 3";
  for (const LegendEntry& entry : colors.legend) {
    EXPECT_NE(entry.text.find("term"), std::string::npos) << entry.text;
  }
}

TEST(OverlayColors, PatchSizesAreThoseOfTheTriangles) {
  LightFieldModel model = SmallModel();
  model.placements[3].edge_samples = 33;
  const OverlayColors colors = ColorsOf(Overlay::kPatchSizes, model, {});
  const std::map<int, Eigen::Vector3f> legend = LegendByNumber(colors);
  ASSERT_EQ(colors.corners.size(), 3 * model.mesh.triangles.size());
  std::set<int> sizes;
  for (size_t t = 0; t < model.placements.size(); ++t) {
    const int size = model.placements[t].edge_samples;
    sizes.insert(size);
    ASSERT_TRUE(legend.contains(size)) << size;
    for (int c = 0; c < 3; ++c) EXPECT_EQ(colors.corners[3 * t + c], legend.at(size)) << t;
  }
  ASSERT_EQ(sizes, (std::set<int>{5, 9, 33}));
  EXPECT_EQ(legend.size(), 3u);
  EXPECT_LT(Luminance(legend.at(5)), Luminance(legend.at(9)));
  EXPECT_LT(Luminance(legend.at(9)), Luminance(legend.at(33)));
  for (const LegendEntry& entry : colors.legend) {
    EXPECT_NE(entry.text.find("samples"), std::string::npos) << entry.text;
  }
}

void MarkAsGuessed(LightFieldModel& model, int vertex, int q, bool is_guessed) {
  uint8_t& byte = model.guessed[GuessedBytes(model.grid) * vertex + q / 8];
  const auto bit = static_cast<uint8_t>(1U << q % 8);
  byte = static_cast<uint8_t>(is_guessed ? byte | bit : byte & ~bit);
}

void MarkAll(LightFieldModel& model, bool is_guessed) {
  model.guessed.assign(GuessedBytes(model.grid) * model.mesh.vertices.size(), 0);
  if (is_guessed) std::fill(model.guessed.begin(), model.guessed.end(), uint8_t{255});
}

/// The colours of the legend.
struct GuessedLegend {
  explicit GuessedLegend(const OverlayColors& colors) {
    EXPECT_EQ(colors.legend.size(), 2u);
    for (const LegendEntry& entry : colors.legend) {
      (entry.text.find("guessed") != std::string::npos ? guessed : seen) = entry.color;
    }
    EXPECT_GT(guessed.x(), 2 * std::max(guessed.y(), guessed.z())) << "red";
    EXPECT_GT(seen.y(), 2 * std::max(seen.x(), seen.z())) << "green";
  }
  Eigen::Vector3f seen = Eigen::Vector3f::Zero(), guessed = Eigen::Vector3f::Zero();
};

// In every vertex frame the directions on one side of a slanted plane through the normal are
// guessed: a square that is turned or mirrored would show.
TEST(OverlayColors, GuessedIsTheHalfOfTheSquareThatIsMarked) {
  const Eigen::Vector3d across(0.6, 0.8, 0);
  constexpr double kSide_abs = 0.2;  // nearer to the plane texels may be rounded across it
  for (const DirectionMap map : {DirectionMap::kHemiOctahedral, DirectionMap::kOrthographic,
                                 DirectionMap::kHemiOctahedralSkirt}) {
    LightFieldModel model = SmallModel(map);
    const int vertices = static_cast<int>(model.mesh.vertices.size());
    MarkAll(model, false);
    for (int q = 0; q < kGrid * kGrid; ++q) {
      const bool is_guessed = across.dot(GridDirection(map, kGrid, q)) < 0;
      for (int v = 0; v < vertices; ++v) MarkAsGuessed(model, v, q, is_guessed);
    }
    int guessed = 0, seen = 0, below = 0;
    for (const Eigen::Vector3d& offset : {Eigen::Vector3d(300, 0, 0),
                                          {-90, 200, 50},
                                          {20, -70, -400},
                                          {0, 0, 1e5},
                                          {25, 15, -20}}) {
      OverlayData data;
      data.eye = kCenter + offset;  // the last stands inside, below all horizons
      const OverlayColors colors = ColorsOf(Overlay::kGuessed, model, data);
      const GuessedLegend legend(colors);
      for (int v = 0; v < vertices; ++v) {
        const Eigen::Vector3d direction =
            model.vertex_frames[v].transpose() * (data.eye - model.mesh.vertices[v]).normalized();
        const double side = across.dot(direction);
        if (std::abs(side) < kSide_abs) continue;
        (side < 0 ? guessed : seen) += 1;
        below += direction.z() < -0.4;
        EXPECT_EQ(ColorOfVertex(model, colors, v), side < 0 ? legend.guessed : legend.seen)
            << "vertex " << v << ", eye " << offset.transpose() << ", map "
            << static_cast<int>(map);
      }
    }
    EXPECT_GT(guessed, 40);
    EXPECT_GT(seen, 40);
    EXPECT_GT(below, 40);
  }
}

TEST(OverlayColors, GuessedIsTheTexelNearestToTheDirection) {
  for (const DirectionMap map :
       {DirectionMap::kHemiOctahedral, DirectionMap::kHemiOctahedralSkirt}) {
    LightFieldModel model = SmallModel(map);
    const int vertex = 11;
    for (int q = 0; q < kGrid * kGrid; q += 7) {
      OverlayData data;
      data.eye = model.mesh.vertices[vertex] +
                 250 * (model.vertex_frames[vertex] * GridDirection(map, kGrid, q));
      for (const bool is_guessed : {true, false}) {
        MarkAll(model, !is_guessed);
        MarkAsGuessed(model, vertex, q, is_guessed);
        const OverlayColors colors = ColorsOf(Overlay::kGuessed, model, data);
        const GuessedLegend legend(colors);
        EXPECT_EQ(ColorOfVertex(model, colors, vertex), is_guessed ? legend.guessed : legend.seen)
            << q;
        EXPECT_EQ(ColorOfVertex(model, colors, 12), is_guessed ? legend.seen : legend.guessed) << q;
      }
    }
  }
}

TEST(OverlayColors, AnEyeOnAVertexLooksAlongItsNormal) {
  LightFieldModel model = SmallModel();
  MarkAll(model, false);
  MarkAsGuessed(model, 4, kGrid / 2 * kGrid + kGrid / 2, true);
  OverlayData data;
  data.eye = model.mesh.vertices[4];
  const OverlayColors colors = ColorsOf(Overlay::kGuessed, model, data);
  EXPECT_EQ(ColorOfVertex(model, colors, 4), GuessedLegend(colors).guessed);
}

TEST(OverlayColors, GuessedIsGrayWhereTheModelDoesNotSay) {
  const LightFieldModel model = SmallModel();
  ASSERT_TRUE(model.guessed.empty());
  OverlayData data;
  data.eye = {500, 0, 0};
  ExpectGray(model, ColorsOf(Overlay::kGuessed, model, data));
}

TEST(OverlayColors, OnlyGuessedOnesChangeWithTheEye) {
  LightFieldModel model = SmallModel();
  MarkAll(model, false);
  for (int q = 0; q < kGrid * kGrid / 2; ++q) {
    for (int v = 0; v < static_cast<int>(model.mesh.vertices.size()); ++v) {
      MarkAsGuessed(model, v, q, true);
    }
  }
  OverlayData here, there;
  here.photographs = there.photographs = model.vertex_terms;
  here.eye = {500, 0, 0};
  there.eye = {-500, 0, 0};
  for (const Overlay overlay : {Overlay::kNormals, Overlay::kPhotographs, Overlay::kGuessed,
                                Overlay::kTerms, Overlay::kPatchSizes}) {
    const bool changes =
        ColorsOf(overlay, model, here).corners != ColorsOf(overlay, model, there).corners;
    EXPECT_EQ(changes, overlay == Overlay::kGuessed) << static_cast<int>(overlay);
    EXPECT_EQ(DependsOnEye(overlay), changes) << static_cast<int>(overlay);
  }
}

TEST(OverlayColors, NoOverlayHasNoColours) {
  const LightFieldModel model = SmallModel();
  try {
    ColorsOf(Overlay::kNone, model, {});
    ADD_FAILURE() << "coloured";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kSystem);
  }
}

}  // namespace
}  // namespace lfm
