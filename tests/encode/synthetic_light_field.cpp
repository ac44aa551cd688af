// SPDX-License-Identifier: BSD-3-Clause
#include "tests/encode/synthetic_light_field.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace lfm::testing {
namespace {

LightField::WeightBuffer NearestViews(const std::vector<Eigen::Vector3d>& views_in_frame,
                                      DirectionMap map, int grid) {
  LightField::WeightBuffer buffer;
  for (int q = 0; q < grid * grid; ++q) {
    const Eigen::Vector3d direction = GridDirection(map, grid, q);
    std::vector<std::pair<double, int>> order;
    for (int v = 0; v < static_cast<int>(views_in_frame.size()); ++v) {
      order.emplace_back((views_in_frame[v] - direction).norm(), v);
    }
    std::sort(order.begin(), order.end());
    while (order.size() < 3) order.push_back(order.back());
    double sum = 0;
    for (int k = 0; k < 3; ++k) sum += 1 / (0.05 + order[k].first);
    for (int k = 0; k < 3; ++k) {
      buffer.view.push_back(static_cast<uint16_t>(order[k].second));
      buffer.weight.push_back(static_cast<float>(1 / (0.05 + order[k].first) / sum));
    }
    buffer.seen.push_back(order[0].first < 0.5);
  }
  return buffer;
}

}  // namespace

std::vector<Eigen::Vector3d> SpreadDirections(int count) {
  std::vector<Eigen::Vector3d> directions;
  const double golden = M_PI * (3 - std::sqrt(5.0));
  for (int i = 0; i < count; ++i) {
    const double z = 1 - 2 * (i + 0.5) / count, r = std::sqrt(1 - z * z);
    directions.emplace_back(r * std::cos(golden * i), r * std::sin(golden * i), z);
  }
  return directions;
}

LightFieldSource SyntheticLightField::Source() const {
  int64_t samples = 0;
  for (const Triangle& t : triangles) samples += PatchSampleCount(t.edge_samples);
  return {
      mesh,
      frames,
      direction_map,
      grid,
      [this](int t) {
        return TrianglePatch{triangles[t].edge_samples, triangles[t].photos, triangles[t].values};
      },
      [this](int t, int corner, LightField::WeightBuffer&) {
        const LightField::WeightBuffer& b = triangles[t].weights[corner];
        return ViewWeights{b.view, b.weight, b.seen};
      },
      3 * samples * grid * grid};
}

TriangleMesh MakeSphere(int levels) {
  TriangleMesh mesh;
  mesh.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                    {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [place, fresh] = middles.try_emplace(std::minmax(a, b), mesh.vertices.size());
      if (fresh) mesh.vertices.push_back((mesh.vertices[a] + mesh.vertices[b]).normalized());
      return place->second;
    };
    std::vector<Eigen::Vector3i> finer;
    for (const Eigen::Vector3i& t : mesh.triangles) {
      const int a = middle(t[0], t[1]), b = middle(t[1], t[2]), c = middle(t[2], t[0]);
      finer.insert(finer.end(), {{t[0], a, c}, {a, t[1], b}, {c, b, t[2]}, {a, b, c}});
    }
    mesh.triangles = std::move(finer);
  }
  for (Eigen::Vector3d& p : mesh.vertices) p *= 50;
  mesh.normals = ComputeVertexNormals(mesh);
  return mesh;
}

SyntheticLightField MakeLightField(const TriangleMesh& mesh, int grid, int views,
                                   const std::function<int(int triangle)>& edge_samples,
                                   const Appearance& appearance, const ViewFilter& sees) {
  SyntheticLightField field;
  field.mesh = mesh;
  field.frames = ComputeVertexFrames(mesh);
  field.grid = grid;
  const std::vector<Eigen::Vector3d> directions = SpreadDirections(views);
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    SyntheticLightField::Triangle& triangle = field.triangles.emplace_back();
    const int n = triangle.edge_samples = edge_samples(t);
    const Eigen::Vector3d normal = TriangleNormal(mesh, t);
    for (int v = 0; v < views; ++v) {
      if (sees(directions[v].dot(normal))) triangle.photos.push_back(static_cast<uint16_t>(v));
    }
    const size_t seen = triangle.photos.size();
    triangle.values.resize(static_cast<size_t>(PatchSampleCount(n)) * 3 * seen);
    const Eigen::Vector3i& corners = mesh.triangles[t];
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i + j < n; ++i) {
        const Eigen::Vector3d w = PatchSampleWeights(n, i, j);
        const Eigen::Vector3d p = w[0] * mesh.vertices[corners[0]] +
                                  w[1] * mesh.vertices[corners[1]] +
                                  w[2] * mesh.vertices[corners[2]];
        for (size_t v = 0; v < seen; ++v) {
          const Eigen::Vector3d color = appearance(p, directions[triangle.photos[v]]);
          for (int c = 0; c < 3; ++c) {
            triangle.values[(PatchSampleIndex(n, i, j) * 3 + c) * seen + v] = static_cast<uint16_t>(
                std::lround(std::clamp(color[c], 0.0, 1.9) * LightField::kOne));
          }
        }
      }
    }
    for (int corner = 0; corner < 3 && seen > 0; ++corner) {
      std::vector<Eigen::Vector3d> in_frame;
      for (const uint16_t photo : triangle.photos) {
        in_frame.push_back(field.frames[corners[corner]].transpose() * directions[photo]);
      }
      triangle.weights[corner] = NearestViews(in_frame, field.direction_map, grid);
    }
  }
  return field;
}

Eigen::Vector3d GlossyAppearance(const Eigen::Vector3d& p, const Eigen::Vector3d& to_eye) {
  const Eigen::Vector3d albedo(0.4 + 0.2 * std::sin(0.08 * p.x()) * std::cos(0.06 * p.y()),
                               0.35 + 0.15 * std::sin(0.07 * p.z() + 1),
                               0.3 + 0.1 * std::cos(0.09 * p.y()));
  const Eigen::Vector3d normal = p.normalized();
  const Eigen::Vector3d half = (to_eye + Eigen::Vector3d(0.3, 0.2, 0.93)).normalized();
  const double gloss = std::pow(std::max(0.0, normal.dot(half)), 20);
  return albedo + 0.4 * gloss * Eigen::Vector3d(1, 0.9, 0.8);
}

double ResampledValue(const SyntheticLightField& field, int triangle, int corner, int sample,
                      int channel, int direction) {
  const SyntheticLightField::Triangle& t = field.triangles[triangle];
  const LightField::WeightBuffer& w = t.weights[corner];
  double sum = 0;
  for (int e = 3 * direction; e < 3 * direction + 3; ++e) {
    sum += static_cast<double>(w.weight[e]) *
           t.values[(size_t{3} * sample + channel) * t.photos.size() + w.view[e]] /
           LightField::kOne;
  }
  return sum;
}

}  // namespace lfm::testing
