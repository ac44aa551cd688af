// SPDX-License-Identifier: BSD-3-Clause
#include "fields/vertex_functions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/cube_map.h"
#include "core/image.h"
#include "core/parallel.h"
#include "resample/dense_light_field.h"
#include "tests/fields/field_files.h"
#include "tests/support/scratch_folder.h"

namespace lfm::testing {
namespace {

constexpr int kGrid = 5, kEntries = kGrid * kGrid, kViews = 4;

/// A square pyramid without its floor, a triangle that hangs apart, and a vertex of no triangle.
TriangleMesh Pyramid() {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 10}, {10, 0, 0},  {0, 10, 0},  {-10, 0, 0}, {0, -10, 0},
                   {50, 0, 0}, {60, 0, 10}, {50, 10, 0}, {90, 90, 90}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {4, 1, 0}, {5, 6, 7}};
  mesh.normals = ComputeVertexNormals(mesh);
  return mesh;
}

using ValueOf = std::function<double(int triangle, int sample, int channel, int view)>;
using SeenOf = std::function<bool(int triangle, int corner, int q)>;

/// A light field of Pyramid() whose last triangle nobody sees; weights are random.
class VertexFunctionsTest : public ::testing::Test {
 protected:
  LightField Make(const ValueOf& value, const SeenOf& seen,
                  DirectionMap map = DirectionMap::kHemiOctahedral) {
    LightFieldWriter::Header header;
    header.mesh = Pyramid();
    header.vertex_frames = ComputeVertexFrames(header.mesh);
    header.photo_ids = {"a", "b", "c", "d"};
    header.direction_map = map;
    header.grid = kGrid;
    const std::filesystem::path file = scratch_.folder / "light_field.lfs";
    LightFieldWriter writer(file, header);
    std::mt19937 random(3);
    for (int t = 0; t < static_cast<int>(header.mesh.triangles.size()); ++t) {
      LightFieldWriter::Triangle triangle;
      triangle.edge_samples = 2 + t % 3;
      if (t < 4) {
        triangle.photos = {0, 1, 2, 3};
        const int samples = triangle.edge_samples * (triangle.edge_samples + 1) / 2;
        for (int s = 0; s < samples; ++s) {
          for (int c = 0; c < 3; ++c) {
            for (int v = 0; v < kViews; ++v) {
              triangle.values.push_back(
                  static_cast<uint16_t>(std::lround(value(t, s, c, v) * LightField::kOne)));
            }
          }
        }
        for (int corner = 0; corner < 3; ++corner) {
          for (int q = 0; q < kEntries; ++q) {
            AddRandomWeights(random, triangle.weights[static_cast<size_t>(corner)]);
            triangle.weights[static_cast<size_t>(corner)].seen.push_back(seen(t, corner, q) ? 1
                                                                                            : 0);
          }
        }
      }
      writer.Write(triangle);
    }
    writer.Finish();
    return LightField::Open(file);
  }

 private:
  static void AddRandomWeights(std::mt19937& random, LightField::WeightBuffer& weights) {
    const int first = static_cast<int>(random() % kViews);
    const float a = static_cast<float>(random() % 100) / 200,
                b = static_cast<float>(random() % 100) / 200;
    for (int k = 0; k < 3; ++k) {
      weights.view.push_back(static_cast<uint16_t>((first + k) % kViews));
    }
    weights.weight.insert(weights.weight.end(), {a, b, 1 - a - b});
  }

  ScratchFolder scratch_;
};

double RandomValue(int triangle, int sample, int channel, int view) {
  return std::fmod(0.37 * triangle + 0.61 * sample + 0.29 * channel + 0.83 * view, 1.2);
}

bool RandomlySeen(int triangle, int corner, int q) {
  return (triangle * 7 + corner * 3 + q * 5) % 4 != 0 && q % 9 != 4;
}

struct Expected {
  double value = 0;
  bool seen = false;
};

/// Straight from the definition, by the resampled matrix.
Expected ByDefinition(const LightField& light_field, const SeenOf& seen, int vertex, int channel,
                      int q) {
  double sum[2] = {0, 0};
  int count[2] = {0, 0};
  for (int t = 0; t < light_field.triangle_count(); ++t) {
    const int n = light_field.Patch(t).edge_samples;
    for (int corner = 0; corner < 3; ++corner) {
      if (light_field.mesh().triangles[static_cast<size_t>(t)][corner] != vertex || t == 4)
        continue;
      const int samples[3] = {0, n - 1, n * (n + 1) / 2 - 1};
      const std::vector<float> block = DenseBlock(light_field, t, corner);
      const double value =
          block[static_cast<size_t>((samples[corner] * 3 + channel) * kEntries + q)];
      for (int only_seen = 0; only_seen < 2; ++only_seen) {
        if (only_seen == 1 && !seen(t, corner, q)) continue;
        sum[only_seen] += value;
        ++count[only_seen];
      }
    }
  }
  const int kind = count[1] > 0 ? 1 : 0;
  return {count[kind] > 0 ? sum[kind] / count[kind] : 0, kind == 1};
}

TEST_F(VertexFunctionsTest, AreTheMeanOfWhatTrianglesSawAtTheVertex) {
  constexpr double kValue_abs = 2e-6;
  const LightField light_field = Make(RandomValue, RandomlySeen);
  const VertexFunctions coded =
      ReadVertexFunctions(light_field, {.space = RadianceSpace::kSrgbCoded}, SilentProgress());
  const VertexFunctions linear = ReadVertexFunctions(light_field, {}, SilentProgress());
  const Field& field = coded.field;
  EXPECT_EQ(field.kind, FieldColumns::kViews);
  ASSERT_EQ(field.points, 9);
  ASSERT_EQ(field.channels, 3);
  ASSERT_EQ(field.functions.rows, 27);
  ASSERT_EQ(field.functions.columns, kEntries);
  EXPECT_EQ(field.positions[6], Eigen::Vector3f(60, 0, 10));
  int seen_entries = 0, guessed_entries = 0;
  for (int v = 0; v < 9; ++v) {
    for (int q = 0; q < kEntries; ++q) {
      EXPECT_EQ(field.directions[static_cast<size_t>(q)],
                GridDirection(DirectionMap::kHemiOctahedral, kGrid, q));
      for (int c = 0; c < 3; ++c) {
        const Expected expected = ByDefinition(light_field, RandomlySeen, v, c, q);
        EXPECT_NEAR(field.functions.Row(field.RowOf(v, c))[q], expected.value, kValue_abs);
        EXPECT_NEAR(linear.field.functions.Row(field.RowOf(v, c))[q],
                    LinearFromSrgb(static_cast<float>(expected.value)), 3 * kValue_abs);
        EXPECT_EQ(coded.seen[static_cast<size_t>(v * kEntries + q)] == 1, expected.seen);
        (expected.seen ? seen_entries : guessed_entries) += 1;
      }
    }
  }
  EXPECT_GT(seen_entries, 100);
  EXPECT_GT(guessed_entries, 30);
  EXPECT_EQ(coded.seen, linear.seen);
  EXPECT_EQ(coded.unseen_vertices, (std::vector<int64_t>{5, 6, 7, 8}));
  EXPECT_EQ(field.mask, (std::vector<uint8_t>{1, 1, 1, 1, 1, 0, 0, 0, 0}));
}

TEST_F(VertexFunctionsTest, DoNotDependOnTheNumberOfThreads) {
  const LightField light_field = Make(RandomValue, RandomlySeen);
  SetThreadCount(1);
  const VertexFunctions one = ReadVertexFunctions(light_field, {}, SilentProgress());
  SetThreadCount(4);
  const VertexFunctions four = ReadVertexFunctions(light_field, {}, SilentProgress());
  SetThreadCount(0);
  EXPECT_EQ(one.field.functions.values, four.field.functions.values);
  EXPECT_EQ(one.seen, four.seen);
}

TEST_F(VertexFunctionsTest, AConstantOnTheGridIsConstantOverTheWorldsHemisphere) {
  for (const DirectionMap map : {DirectionMap::kHemiOctahedral, DirectionMap::kOrthographic,
                                 DirectionMap::kHemiOctahedralSkirt}) {
    const LightField light_field = Make([](int, int, int c, int) { return 0.25 * (c + 1); },
                                        [](int, int, int) { return true; }, map);
    const VertexFunctions made = ReadVertexFunctions(
        light_field, {.directions = VertexDirections::kWorldCube, .cube_resolution = 6},
        SilentProgress());
    const CubeMap cube{6};
    ASSERT_EQ(made.field.functions.columns, cube.Texels());
    const double lowest = map == DirectionMap::kHemiOctahedralSkirt ? -kSkirt : 0;
    for (int v = 0; v < 5; ++v) {
      const Eigen::Vector3d normal = light_field.vertex_frames()[static_cast<size_t>(v)].col(2);
      for (int t = 0; t < cube.Texels(); ++t) {
        const Eigen::Vector3d& direction = made.field.directions[static_cast<size_t>(t)];
        EXPECT_EQ(cube.TexelOf(direction.cast<float>()), t);
        const double height = normal.dot(direction);
        if (std::abs(height - lowest) < 1e-9) continue;
        EXPECT_EQ(made.seen[static_cast<size_t>(v * cube.Texels() + t)] == 1, height > lowest);
        for (int c = 0; c < 3; ++c) {
          const double expected = height > lowest ? LinearFromSrgb(0.25F * (c + 1)) : 0;
          EXPECT_NEAR(made.field.functions.Row(made.field.RowOf(v, c))[t], expected, 1e-5);
        }
      }
    }
  }
}

TEST_F(VertexFunctionsTest, TheWorldsCubeFollowsTheFramesDirections) {
  // On the orthographic disc a bilinear grid reproduces what is linear in the frame's x and y; the
  // first view shows x, the second nothing, so that a weight of the first is a value.
  const LightField light_field =
      Make([](int, int, int c, int view) { return c == 0 && view == 0 ? 1.0 : 0.0; },
           [](int, int, int q) { return q != kEntries / 2; }, DirectionMap::kOrthographic);
  const VertexFunctions grid =
      ReadVertexFunctions(light_field, {.space = RadianceSpace::kSrgbCoded}, SilentProgress());
  const VertexFunctions made = ReadVertexFunctions(light_field,
                                                   {.space = RadianceSpace::kSrgbCoded,
                                                    .directions = VertexDirections::kWorldCube,
                                                    .cube_resolution = 9},
                                                   SilentProgress());
  for (int v = 0; v < 5; ++v) {
    const Eigen::Matrix3d& frame = light_field.vertex_frames()[static_cast<size_t>(v)];
    for (int t = 0; t < made.field.functions.columns; ++t) {
      const Eigen::Vector3d d = frame.transpose() * made.field.directions[static_cast<size_t>(t)];
      if (d.z() < 1e-9) continue;
      // The hat functions of all grid entries, whole, against the four of the cell.
      double expected = 0;
      bool seen = true;
      for (int q = 0; q < kEntries; ++q) {
        const double x = (d.x() + 1) / 2 * (kGrid - 1) - q % kGrid;
        const double y = (d.y() + 1) / 2 * (kGrid - 1) - q / kGrid;
        const double hat = std::max(0.0, 1 - std::abs(x)) * std::max(0.0, 1 - std::abs(y));
        expected += hat * static_cast<double>(grid.field.functions.Row(v)[q]);
        if (hat > 1e-9 && q == kEntries / 2) seen = false;
      }
      EXPECT_NEAR(made.field.functions.Row(v)[t], expected, 1e-6);
      EXPECT_EQ(made.seen[static_cast<size_t>(v * made.field.functions.columns + t)] == 1, seen);
    }
  }
}

TEST_F(VertexFunctionsTest, OptionsOutOfRangeAreRefused) {
  const LightField light_field = Make(RandomValue, RandomlySeen);
  ExpectErrorWith({"vertex-cube"}, [&] {
    ReadVertexFunctions(light_field, {.cube_resolution = 0}, SilentProgress());
  });
}

}  // namespace
}  // namespace lfm::testing
