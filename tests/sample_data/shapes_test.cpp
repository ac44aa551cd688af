// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/parallel.h"
#include "sample_data/builtin_scenes.h"
#include "sample_data/shapes/box_shape.h"
#include "sample_data/shapes/lathe_shape.h"
#include "sample_data/shapes/plant_shape.h"
#include "sample_data/shapes/round_shape.h"
#include "sample_data/shapes/shape_generators.h"
#include "sample_data/shapes/star_shape.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;
constexpr double kPi = std::numbers::pi;

Shape Generate(const std::string& text, SceneDetail detail = SceneDetail::kTiny) {
  const nlohmann::json json = nlohmann::json::parse(text);
  JsonReader reader(json, "test");
  return GenerateShape(reader, detail);
}

// Closed, outward, and shaded as it is shaped: normals of vertices agree with their triangles.
void ExpectGoodSolid(const Shape& shape, const std::string& what) {
  const MeshTopology topology = ExamineTopology(shape.mesh);
  EXPECT_TRUE(topology.closed && topology.manifold) << what;
  EXPECT_EQ(topology.degenerate_triangles, 0) << what;
  EXPECT_GT(SignedVolume(shape.mesh), 0) << what;
  ASSERT_EQ(shape.mesh.normals.size(), shape.mesh.vertices.size()) << what;
  const std::vector<V3> geometric = ComputeVertexNormals(shape.mesh);
  size_t against = 0;
  for (size_t v = 0; v < geometric.size(); ++v) {
    ASSERT_TRUE(shape.mesh.vertices[v].allFinite()) << what;
    ASSERT_NEAR(shape.mesh.normals[v].norm(), 1, 1e-6) << what;
    against += shape.mesh.normals[v].dot(geometric[v]) < 0;
  }
  EXPECT_LE(against, geometric.size() / 50) << what;
}

TEST(Shapes, SmallGeneratorsMakeGoodSolids) {
  for (const char* text :
       {R"({"generator": "box"})", R"({"generator": "ring-wall"})", R"({"generator": "blockers"})",
        R"({"generator": "ellipsoid"})", R"({"generator": "hemisphere"})",
        R"({"generator": "bowl"})", R"({"generator": "star"})", R"({"generator": "plant"})",
        R"({"generator": "plant", "part": "stems"})", R"({"generator": "turtle", "part": "eyes"})",
        R"({"generator": "knight", "part": "base"})",
        R"({"generator": "knight", "part": "sword"})"}) {
    ExpectGoodSolid(Generate(text), text);
  }
}

// The larger ones are examined where the built-in scenes are.
TEST(Shapes, EveryGeneratorStandsInABuiltInScene) {
  std::string texts;
  for (const auto& [name, text] : BuiltinSceneTexts()) texts += text;
  for (const std::string& name : ShapeGeneratorNames()) {
    EXPECT_NE(texts.find("\"generator\": \"" + name + "\""), std::string::npos) << name;
  }
}

TEST(Shapes, EllipsoidIsExact) {
  const V3 radii(50, 30, 20);
  const Shape shape = MakeEllipsoid(radii, 2);
  EXPECT_NEAR(SignedVolume(shape.mesh) / (4.0 / 3 * kPi * radii.prod()), 1, 3e-3);
  for (size_t v = 0; v < shape.mesh.vertices.size(); ++v) {
    const V3 q = shape.mesh.vertices[v].cwiseQuotient(radii);
    ASSERT_NEAR(q.norm(), 1, 1e-12);
    ASSERT_NEAR(shape.mesh.normals[v].dot(q.cwiseQuotient(radii).normalized()), 1, 1e-12);
  }
}

TEST(Shapes, HemisphereAndBowlHaveTheBallsNormals) {
  const Shape dome = MakeHemisphere(50, 1);
  EXPECT_NEAR(SignedVolume(dome.mesh) / (2.0 / 3 * kPi * 125000), 1, 2e-3);
  const Shape bowl = MakeBowl(50, 3, 1);
  const double bowl_volume = 2.0 / 3 * kPi * (53.0 * 53 * 53 - 125000);
  EXPECT_NEAR(SignedVolume(bowl.mesh) / bowl_volume, 1, 5e-3);
  ExpectGoodSolid(dome, "hemisphere");
  ExpectGoodSolid(bowl, "bowl");
  for (size_t v = 0; v < dome.mesh.vertices.size(); ++v) {
    const V3& p = dome.mesh.vertices[v];
    if (p.norm() > 49.99) {
      ASSERT_NEAR(dome.mesh.normals[v].dot(p) / 50, 1, 1e-12);
    }
  }
  size_t inside = 0;
  for (size_t v = 0; v < bowl.mesh.vertices.size(); ++v) {
    const V3& p = bowl.mesh.vertices[v];
    if (std::abs(p.norm() - 50) > 1e-9) continue;
    ASSERT_NEAR(bowl.mesh.normals[v].dot(p) / 50, -1, 1e-12);
    ++inside;
  }
  EXPECT_GT(inside, bowl.mesh.vertices.size() / 3);
}

TEST(Shapes, BoxesHaveTheirVolumeLessTheBevels) {
  const V3 size(10, 20, 30);
  const double bevel = 0.5;
  const Shape box = MakeBox(size, bevel, 3);
  ExpectGoodSolid(box, "box");
  // A bevel cuts a prism off each edge; three of them overlap in each corner.
  const double edges = 4 * ((size - V3::Constant(2 * bevel)).sum()) * bevel * bevel / 2;
  EXPECT_NEAR(SignedVolume(box.mesh), size.prod() - edges, 8 * bevel * bevel * bevel);
  EXPECT_EQ(box.uv.size(), box.mesh.vertices.size());
  const Shape wall = MakeRingWall(50, 54, 40, kPi, 0.2, 2);
  ExpectGoodSolid(wall, "wall");
  EXPECT_NEAR(SignedVolume(wall.mesh) / (kPi / 2 * (54.0 * 54 - 2500) * 40), 1, 0.01);
  const Shape grid = MakeBlockers(3, 2, {4, 4, 8}, {10, 12}, 0.1, 10);
  EXPECT_EQ(ExamineTopology(grid.mesh).components, 6);
}

TEST(Shapes, LatheTurnsProfilesAndSheetIsOpen) {
  const Shape cylinder = MakeLathe({{0, 0}, {10, 0}, {10, 30}, {0, 30}}, 0.2, 1);
  ExpectGoodSolid(cylinder, "cylinder");
  EXPECT_NEAR(SignedVolume(cylinder.mesh) / (kPi * 100 * 30), 1, 0.01);
  const Shape hollow = MakeLathe({{0, 0}, {10, 0}, {10, 30}, {8, 30}, {8, 2}, {0, 2}}, 0.2, 1);
  ExpectGoodSolid(hollow, "hollow");
  EXPECT_NEAR(SignedVolume(hollow.mesh) / (kPi * (100 * 30 - 64 * 28)), 1, 0.02);
  Flutes flutes;
  flutes.count = 12;
  flutes.depth_mm = 1;
  flutes.low_mm = 3;
  flutes.high_mm = 27;
  const Shape column = MakeLathe({{0, 0}, {10, 0}, {10, 30}, {0, 30}}, 0.2, 1, flutes);
  ExpectGoodSolid(column, "column");
  EXPECT_LT(SignedVolume(column.mesh), 0.95 * SignedVolume(cylinder.mesh));
  EXPECT_THROW(MakeLathe({{0, 0}, {10, 0}}, 0.2, 1), Error);
  EXPECT_THROW(MakeLathe({{0, 0}, {10, 0}, {0, 5}, {0, 9}}, 0.2, 1), Error);
  const Shape sheet = MakeSheet(40, 20, 5);
  EXPECT_EQ(sheet.mesh.vertices.size(), 45u);
  EXPECT_EQ(ExamineTopology(sheet.mesh).boundary_edges, 24);
}

TEST(Shapes, StarHasFlatFacets) {
  const Shape star = MakeStar({}, 1.5);
  std::vector<V3> facets;
  size_t flat = 0;
  for (const V3& n : star.mesh.normals) {
    size_t same = 0;
    for (size_t v = 0; v < star.mesh.normals.size(); v += 5) {
      same += n.dot(star.mesh.normals[v]) > 1 - 1e-6;
    }
    flat += same > 20;
  }
  EXPECT_GT(flat, star.mesh.normals.size() / 2);
}

TEST(Shapes, TreeHasLeavesAndBranchesThatMeet) {
  const Shape leaves = Generate(R"({"generator": "tree", "levels": 3})");
  ExpectGoodSolid(leaves, "leaves");
  EXPECT_GT(ExamineTopology(leaves.mesh).components, 50);
  EXPECT_EQ(leaves.uv.size(), leaves.mesh.vertices.size());
  const Shape stems = Generate(R"({"generator": "tree", "part": "stems", "levels": 3})");
  ExpectGoodSolid(stems, "branches");
  Eigen::AlignedBox3d box;
  for (const V3& p : stems.mesh.vertices) box.extend(p);
  // Leaves grow where there are branches.
  for (const V3& p : leaves.mesh.vertices) ASSERT_LT(box.exteriorDistance(p), 15);
}

TEST(Shapes, DoNotDependOnTheNumberOfThreads) {
  const std::string text = R"({"generator": "dancer", "tiny_edge_mm": 1.6})";
  SetThreadCount(1);
  const Shape one = Generate(text);
  SetThreadCount(3);
  const Shape three = Generate(text);
  SetThreadCount(0);
  ASSERT_EQ(one.mesh.vertices.size(), three.mesh.vertices.size());
  for (size_t v = 0; v < one.mesh.vertices.size(); ++v) {
    ASSERT_EQ(one.mesh.vertices[v], three.mesh.vertices[v]);
    ASSERT_EQ(one.paint[v].diffuse, three.paint[v].diffuse);
  }
}

TEST(Shapes, SeedsChangePlants) {
  const Shape a = Generate(R"({"generator": "plant", "seed": 1})");
  const Shape b = Generate(R"({"generator": "plant", "seed": 2})");
  ASSERT_EQ(a.mesh.vertices.size(), b.mesh.vertices.size());
  EXPECT_NE(a.mesh.vertices, b.mesh.vertices);
}

TEST(Shapes, BadParametersAreNamed) {
  const std::pair<const char*, const char*> cases[] = {
      {R"({"generator": "blob"})", "test: generator: there is no shape 'blob'"},
      {R"({"generator": "box", "size": 3})", "test: size: unknown key"},
      {R"({"generator": "box", "size_mm": [1, 2]})", "test: size_mm: expected an array of 3"},
      {R"({"generator": "box", "size_mm": [1, 2, -3]})",
       "test: size_mm: expected a number between"},
      {R"({"generator": "box", "size_mm": [1, 1, 1], "bevel_mm": 0.6})", "a box needs a bevel"},
      {R"({"generator": "star", "notch_mm": 80})", "0 < notch < tip"},
      {R"({"generator": "bust", "edge_mm": 0})", "test: edge_mm: expected a number between"},
      {R"({"generator": "turtle", "part": "wing"})", "'wing' is none of body, shell"},
      {R"({"generator": "lathe", "profile_mm": [[0, 0], [1, 1]]})", "profile needs three points"},
      {R"({"generator": "lathe", "profile_mm": [[0, 0, 0]]})", "rows of 2 finite numbers"},
      {R"({"generator": "lathe"})", "profile needs three points"},
      {R"({"generator": "sheet", "width_mm": 1e4, "depth_mm": 1e4, "tiny_edge_mm": 0.05})",
       "more than 4 million triangles"},
      {R"({"generator": "statue", "tiny_edge_mm": 0.05})", "more than 400 million cells"},
      {R"({"generator": "ellipsoid", "radii_mm": [1e4, 1, 1], "tiny_edge_mm": 0.05})",
       "more than 4 million triangles"},
  };
  for (const auto& [text, message] : cases) {
    try {
      Generate(text);
      ADD_FAILURE() << text;
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find(message), std::string::npos) << e.what();
    }
  }
}

}  // namespace
}  // namespace lfm
