// SPDX-License-Identifier: BSD-3-Clause
#include "synthetic_model.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

namespace lfm {
namespace {

constexpr int kCell = 13;  // two patches of up to 9 samples an edge, with their gutters
constexpr int kCellColumns = 6, kCellRows = 4;
constexpr int kTileColumns = 4, kTileRows = 3;

using EdgeMidpoints = std::map<std::pair<int, int>, int>;

int Midpoint(int a, int b, std::vector<Eigen::Vector3d>& directions, EdgeMidpoints& midpoints) {
  const auto [entry, is_new] =
      midpoints.try_emplace(std::minmax(a, b), static_cast<int>(directions.size()));
  if (is_new) directions.push_back((directions[a] + directions[b]).normalized());
  return entry->second;
}

uint8_t Code(double value, const MapRange& range) {
  return static_cast<uint8_t>(
      std::clamp(std::lround(255 * (value - range.bias) / range.scale), 0L, 255L));
}

std::vector<Image> MakePages(int count, int width, int height) {
  return std::vector<Image>(count,
                            Image(width, height, 3, PixelType::kUint8, ColorEncoding::kSrgb));
}

PatchPlacement PlaceTriangle(int t) {
  const int cell = t / 2 % (kCellColumns * kCellRows);
  PatchPlacement placement;
  placement.page = t / 2 / (kCellColumns * kCellRows);
  placement.edge_samples = t / 2 % 3 == 0 ? 5 : 9;
  placement.flipped = t % 2 == 1;
  placement.origin = {cell % kCellColumns * kCell + 1, cell / kCellColumns * kCell + 1};
  // The partner comes from the far corner of the square that holds both and their gutter.
  if (placement.flipped) placement.origin.array() += placement.edge_samples + 1;
  return placement;
}

/// Visits the texels of a patch and of its gutter, with weights that go on linearly.
template <typename Visit>
void ForEachPatchTexel(const PatchPlacement& placement, const Visit& visit) {
  const int n = placement.edge_samples;
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i + j <= n; ++i) {
      const double u = static_cast<double>(i) / (n - 1), v = static_cast<double>(j) / (n - 1);
      const int sign = placement.flipped ? -1 : 1;
      visit(placement.origin.x() + sign * i, placement.origin.y() + sign * j,
            Eigen::Vector3d(1 - u - v, u, v));
    }
  }
}

void FillSurfaces(const ModelRecipe& recipe, LightFieldModel& model) {
  const size_t vertices = model.mesh.vertices.size();
  for (size_t t = 0; t < model.mesh.triangles.size(); ++t) {
    const Eigen::Vector3i& triangle = model.mesh.triangles[t];
    const PatchPlacement& placement = model.placements[t];
    ForEachPatchTexel(placement, [&](int x, int y, const Eigen::Vector3d& weights) {
      Eigen::Vector3d point = Eigen::Vector3d::Zero();
      for (int c = 0; c < 3; ++c) point += weights[c] * model.mesh.vertices[triangle[c]];
      const Eigen::Vector3d mean = recipe.mean(point);
      for (int c = 0; c < 3; ++c) {
        model.mean_pages[placement.page].At<uint8_t>(x, y, c) = Code(mean[c], {1, 0});
        for (int k = 0; k < model.terms; ++k) {
          model.surface_pages[k][placement.page].At<uint8_t>(x, y, c) =
              Code(weights[c] * recipe.surface(k, point),
                   model.surface_ranges[k * vertices + triangle[c]]);
        }
      }
    });
  }
}

void FillViews(const ModelRecipe& recipe, LightFieldModel& model) {
  const int vertices = static_cast<int>(model.mesh.vertices.size());
  const double step = 1.0 / (model.grid - 1);
  for (int k = 0; k < model.terms; ++k) {
    for (int v = 0; v < vertices; ++v) {
      const LightFieldModel::TilePosition tile = model.ViewTile(k, v);
      for (int q = 0; q < model.grid * model.grid; ++q) {
        const int x = q % model.grid, y = q / model.grid;
        const Eigen::Vector3d value = recipe.view(k, v, {x * step, y * step});
        for (int c = 0; c < 3; ++c) {
          model.view_pages[k][tile.page].At<uint8_t>(tile.x + x, tile.y + y, c) =
              Code(value[c], model.view_ranges[k * vertices + v]);
        }
      }
    }
  }
}

/// A sum of a few waves with random directions and phases, within [-1, 1].
class Waves {
 public:
  Waves(std::mt19937& random, double max_frequency) {
    std::uniform_real_distribution<double> frequency(-max_frequency, max_frequency);
    std::uniform_real_distribution<double> phase(0, 2 * std::numbers::pi);
    for (Wave& wave : waves_) {
      wave = {{frequency(random), frequency(random), frequency(random)}, phase(random)};
    }
  }
  double operator()(const Eigen::Vector3d& p) const {
    double sum = 0;
    for (const Wave& wave : waves_) sum += std::cos(wave.frequency.dot(p) + wave.phase);
    return sum / waves_.size();
  }

 private:
  struct Wave {
    Eigen::Vector3d frequency;
    double phase;
  };
  std::array<Wave, 3> waves_;
};

}  // namespace

TriangleMesh MakeSphere(double radius, const Eigen::Vector3d& center, int levels) {
  const double golden = std::numbers::phi;
  std::vector<Eigen::Vector3d> directions = {{-1, golden, 0},  {1, golden, 0},   {-1, -golden, 0},
                                             {1, -golden, 0},  {0, -1, golden},  {0, 1, golden},
                                             {0, -1, -golden}, {0, 1, -golden},  {golden, 0, -1},
                                             {golden, 0, 1},   {-golden, 0, -1}, {-golden, 0, 1}};
  for (Eigen::Vector3d& direction : directions) direction.normalize();
  std::vector<Eigen::Vector3i> triangles = {
      {0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
      {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
      {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int level = 0; level < levels; ++level) {
    EdgeMidpoints midpoints;
    std::vector<Eigen::Vector3i> finer;
    for (const Eigen::Vector3i& t : triangles) {
      const int a = Midpoint(t[0], t[1], directions, midpoints);
      const int b = Midpoint(t[1], t[2], directions, midpoints);
      const int c = Midpoint(t[2], t[0], directions, midpoints);
      finer.insert(finer.end(), {{t[0], a, c}, {a, t[1], b}, {c, b, t[2]}, {a, b, c}});
    }
    triangles = std::move(finer);
  }
  TriangleMesh mesh;
  mesh.triangles = std::move(triangles);
  for (const Eigen::Vector3d& direction : directions) {
    mesh.vertices.push_back(center + radius * direction);
    mesh.normals.push_back(direction);
  }
  return mesh;
}

LightFieldModel MakeModel(const TriangleMesh& mesh, const ModelRecipe& recipe) {
  LightFieldModel model;
  model.mesh = mesh;
  model.vertex_frames = ComputeVertexFrames(mesh);
  model.direction_map = recipe.direction_map;
  model.grid = recipe.grid;
  model.terms = recipe.terms;
  const int vertices = static_cast<int>(mesh.vertices.size());
  const int triangles = static_cast<int>(mesh.triangles.size());
  for (int t = 0; t < triangles; ++t) model.placements.push_back(PlaceTriangle(t));
  model.view_tiles_per_row = kTileColumns;
  model.view_tiles_per_page = kTileColumns * kTileRows;
  const int surface_pages = model.placements.back().page + 1;
  const int view_pages = (vertices - 1) / model.view_tiles_per_page + 1;
  model.mean_pages = MakePages(surface_pages, kCellColumns * kCell, kCellRows * kCell);
  model.surface_pages.assign(model.terms, model.mean_pages);
  model.view_pages.assign(
      model.terms, MakePages(view_pages, kTileColumns * recipe.grid, kTileRows * recipe.grid));
  for (int v = 0; v < vertices; ++v) {
    model.vertex_terms.push_back(recipe.vertex_terms ? recipe.vertex_terms(v) : model.terms);
  }
  model.view_slots = RankByTerms(model.vertex_terms);
  for (int k = 0; k < model.terms; ++k) {
    for (int v = 0; v < vertices; ++v) {
      const float wider = 0.1f * static_cast<float>((v + 2 * k) % 5);
      model.surface_ranges.push_back({2.6f + wider, -1.3f - wider / 2});
      model.view_ranges.push_back({2.0f + wider, -1.0f - wider / 3});
    }
  }
  FillSurfaces(recipe, model);
  FillViews(recipe, model);
  return model;
}

LightFieldModel MakeSmoothRandomModel(uint32_t seed, DirectionMap direction_map) {
  std::mt19937 random(seed);
  constexpr int kTerms = 3;
  constexpr double kPointFrequency = 0.06;  // a wave is at least 100 mm long
  constexpr double kSquareFrequency = 6;    // at most about one wave a view map
  std::vector<Waves> mean, surface, view;
  for (int c = 0; c < 3; ++c) mean.emplace_back(random, kPointFrequency);
  for (int k = 0; k < kTerms; ++k) surface.emplace_back(random, kPointFrequency);
  for (int i = 0; i < 3 * kTerms; ++i) view.emplace_back(random, kSquareFrequency);
  ModelRecipe recipe;
  recipe.terms = kTerms;
  recipe.direction_map = direction_map;
  recipe.mean = [&](const Eigen::Vector3d& p) {
    return Eigen::Vector3d(0.5 + 0.3 * mean[0](p), 0.5 + 0.3 * mean[1](p), 0.5 + 0.3 * mean[2](p));
  };
  recipe.surface = [&](int k, const Eigen::Vector3d& p) { return surface[k](p); };
  recipe.view = [&](int k, int vertex, const Eigen::Vector2d& square) {
    const Eigen::Vector3d at(square.x(), square.y(), 0.7 * vertex);
    return Eigen::Vector3d(0.6 * view[3 * k](at), 0.6 * view[3 * k + 1](at),
                           0.6 * view[3 * k + 2](at));
  };
  recipe.vertex_terms = [](int vertex) { return vertex % 5 == 0 ? vertex / 5 % kTerms : kTerms; };
  return MakeModel(MakeSphere(60, {10, -20, 80}, 2), recipe);
}

}  // namespace lfm
