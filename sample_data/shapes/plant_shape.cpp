// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/shapes/plant_shape.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "sample_data/random.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;
const double kGoldenAngle = kPi * (3 - std::sqrt(5.0));

V3 Around(double angle, double tilt) {
  return {std::cos(angle) * std::cos(tilt), std::sin(angle) * std::cos(tilt), std::sin(tilt)};
}

// Half the width at u in [0, 1] from stalk to tip, as a share of the leaf's.
double Outline(double u) { return std::pow(std::sin(kPi * std::pow(0.03 + 0.955 * u, 0.8)), 0.9); }

void AddLeaf(const Leaf& leaf, double thickness, int segments, Shape& shape) {
  const V3 side = leaf.up.cross(leaf.direction).normalized();
  const int across = std::max(2, segments / 4) * 2;
  const int first = static_cast<int>(shape.mesh.vertices.size());
  const int layer = (segments + 1) * (across + 1);
  std::vector<V3> upper(layer);
  V3 middle = leaf.base;
  for (int i = 0; i <= segments; ++i) {
    const double u = static_cast<double>(i) / segments;
    const V3 along = Eigen::AngleAxisd(leaf.droop * u * u, side) * leaf.direction;
    const V3 up = along.cross(side);
    if (i > 0) middle += leaf.length_mm / segments * along;
    const double half = 0.5 * leaf.width_mm * Outline(u);
    for (int j = 0; j <= across; ++j) {
      const double v = 2.0 * j / across - 1;
      const double wave = 0.06 * std::abs(v) * std::sin(4 * kPi * u + (v > 0 ? 1.0 : 0.0));
      upper[i * (across + 1) + j] =
          middle +
          half * (v * std::cos(leaf.curl) * side + (std::abs(v) * std::sin(leaf.curl) + wave) * up);
    }
  }
  const auto at = [&](int i, int j) { return i * (across + 1) + j; };
  for (int face = 0; face < 2; ++face) {
    for (int i = 0; i <= segments; ++i) {
      for (int j = 0; j <= across; ++j) {
        const V3 du = upper[at(std::min(i + 1, segments), j)] - upper[at(std::max(i - 1, 0), j)];
        const V3 dv = upper[at(i, std::min(j + 1, across))] - upper[at(i, std::max(j - 1, 0))];
        const V3 normal = (face == 0 ? 1.0 : -1.0) * du.cross(dv).normalized();
        shape.mesh.vertices.push_back(upper[at(i, j)] + 0.5 * thickness * normal);
        shape.mesh.normals.push_back(normal);
        shape.uv.emplace_back(static_cast<float>(i) / static_cast<float>(segments),
                              static_cast<float>(j) / static_cast<float>(across));
      }
    }
  }
  const auto quad = [&](int a, int b, int c, int d) {
    shape.mesh.triangles.emplace_back(first + a, first + b, first + c);
    shape.mesh.triangles.emplace_back(first + a, first + c, first + d);
  };
  for (int i = 0; i < segments; ++i) {
    for (int j = 0; j < across; ++j) {
      quad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
      quad(layer + at(i, j), layer + at(i, j + 1), layer + at(i + 1, j + 1), layer + at(i + 1, j));
    }
    quad(at(i + 1, 0), at(i, 0), layer + at(i, 0), layer + at(i + 1, 0));
    quad(at(i, across), at(i + 1, across), layer + at(i + 1, across), layer + at(i, across));
  }
  for (int j = 0; j < across; ++j) {
    quad(at(0, j), at(0, j + 1), layer + at(0, j + 1), layer + at(0, j));
    quad(at(segments, j + 1), at(segments, j), layer + at(segments, j),
         layer + at(segments, j + 1));
  }
}

int LeafSegments(double length, double edge_mm) {
  return std::clamp(static_cast<int>(std::lround(length / edge_mm)), 4, 24);
}

// A stem of a pot plant: rises, leans out.
struct Stem {
  double around = 0, lean = 0, height = 0;
  V3 Point(double t) const {
    const double out = 5 + height * std::sin(lean) * std::pow(t, 1.5);
    return {out * std::cos(around), out * std::sin(around), height * std::cos(lean) * t};
  }
};

std::vector<Stem> Stems(const PlantSizes& sizes, uint64_t seed) {
  std::vector<Stem> stems;
  for (int i = 0; i < sizes.stem_count; ++i) {
    RandomStream random(seed, 1, static_cast<uint64_t>(i));
    Stem stem;
    stem.around = kGoldenAngle * i + random.Uniform(-0.3, 0.3);
    const double share = (i + 0.5) / sizes.stem_count;
    stem.lean = 0.12 + 0.45 * share + random.Uniform(-0.05, 0.05);
    stem.height = sizes.height_mm * (0.88 - 0.28 * share + random.Uniform(-0.05, 0.05));
    stems.push_back(stem);
  }
  return stems;
}

// The forks of a tree, from the trunk outwards.
struct Branch {
  V3 from, to, direction;
  double start_radius, end_radius;
  int level;
};

void Grow(const TreeSizes& sizes, uint64_t seed, const V3& from, const V3& direction, double length,
          double radius, int level, uint64_t path, std::vector<Branch>& branches) {
  RandomStream random(seed, 2, path);
  const double end_radius = level == sizes.levels ? 0.3 * radius : 0.72 * radius;
  const V3 to = from + length * direction;
  branches.push_back({from, to, direction, radius, end_radius, level});
  if (level == sizes.levels) return;
  const int forks = level == 0 ? 4 : (random.Uniform() < 0.35 ? 3 : 2);
  const V3 side = direction.unitOrthogonal();
  const double start = random.Uniform(0, 2 * kPi);
  for (int i = 0; i < forks; ++i) {
    const double around = start + 2 * kPi * i / forks + random.Uniform(-0.4, 0.4);
    const V3 axis = Eigen::AngleAxisd(around, direction) * side;
    const double angle = (level == 0 ? 0.75 : 0.55) * random.Uniform(0.75, 1.25);
    V3 turned = Eigen::AngleAxisd(angle, axis) * direction;
    turned = (turned + V3(0, 0, 0.10)).normalized();  // towards the light
    Grow(sizes, seed, to, turned, length * random.Uniform(0.66, 0.84), 0.78 * end_radius, level + 1,
         path * 4 + static_cast<uint64_t>(i) + 1, branches);
  }
}

std::vector<Branch> Branches(const TreeSizes& sizes, uint64_t seed) {
  // The sum of a row of shortening branches is the height.
  double sum = 0, part = 1;
  for (int level = 0; level <= sizes.levels; ++level, part *= 0.74) sum += part;
  std::vector<Branch> branches;
  Grow(sizes, seed, V3::Zero(), V3::UnitZ(), 1.15 * sizes.height_mm / sum, sizes.trunk_radius_mm, 0,
       1, branches);
  return branches;
}

}  // namespace

Shape MakeLeaves(const std::vector<Leaf>& leaves, double thickness_mm, int segments) {
  RequireTriangleCount(2.0 * segments * (segments + 4) * static_cast<double>(leaves.size()));
  Shape shape;
  for (const Leaf& leaf : leaves) AddLeaf(leaf, thickness_mm, segments, shape);
  return shape;
}

Shape MakeTube(const std::vector<V3>& points, double start_radius, double end_radius, int sides) {
  if (points.size() < 2) throw Error("a tube needs two points or more");
  Shape shape;
  const int rings = static_cast<int>(points.size());
  V3 side = (points[1] - points[0]).unitOrthogonal();
  for (int ring = 0; ring < rings; ++ring) {
    const V3 along =
        (points[std::min(ring + 1, rings - 1)] - points[std::max(ring - 1, 0)]).normalized();
    side = (side - side.dot(along) * along).normalized();  // carried along without twist
    const V3 other = along.cross(side);
    const double t = static_cast<double>(ring) / (rings - 1);
    const double radius = start_radius + t * (end_radius - start_radius);
    for (int i = 0; i < sides; ++i) {
      const double angle = 2 * kPi * i / sides;
      const V3 normal = std::cos(angle) * side + std::sin(angle) * other;
      shape.mesh.vertices.push_back(points[ring] + radius * normal);
      shape.mesh.normals.push_back(normal);
    }
  }
  const auto at = [&](int ring, int i) { return ring * sides + i % sides; };
  for (int ring = 0; ring + 1 < rings; ++ring) {
    for (int i = 0; i < sides; ++i) {
      shape.mesh.triangles.emplace_back(at(ring, i), at(ring, i + 1), at(ring + 1, i + 1));
      shape.mesh.triangles.emplace_back(at(ring, i), at(ring + 1, i + 1), at(ring + 1, i));
    }
  }
  const int middle = static_cast<int>(shape.mesh.vertices.size());
  shape.mesh.vertices.insert(shape.mesh.vertices.end(), {points.front(), points.back()});
  shape.mesh.normals.insert(shape.mesh.normals.end(),
                            {V3((points[0] - points[1]).normalized()),
                             V3((points[rings - 1] - points[rings - 2]).normalized())});
  for (int i = 0; i < sides; ++i) {
    shape.mesh.triangles.emplace_back(middle, at(0, i + 1), at(0, i));
    shape.mesh.triangles.emplace_back(middle + 1, at(rings - 1, i), at(rings - 1, i + 1));
  }
  return shape;
}

Shape MakePlant(PlantPart part, const PlantSizes& sizes, uint64_t seed, double edge_mm) {
  const std::vector<Stem> stems = Stems(sizes, seed);
  Shape shape;
  if (part == PlantPart::kStems) {
    const int rings = LeafSegments(sizes.height_mm, 2 * edge_mm) + 2;
    for (const Stem& stem : stems) {
      std::vector<V3> points;
      for (int i = 0; i <= rings; ++i) points.push_back(stem.Point(static_cast<double>(i) / rings));
      AppendShape(shape, MakeTube(points, 1.5, 0.5, 8), V3::Zero());
    }
    return shape;
  }
  std::vector<Leaf> leaves;
  for (int i = 0; i < sizes.leaf_count; ++i) {
    RandomStream random(seed, 3, static_cast<uint64_t>(i));
    const Stem& stem = stems[i % stems.size()];
    const int rank = i / static_cast<int>(stems.size());
    const int ranks = (sizes.leaf_count - 1) / static_cast<int>(stems.size()) + 1;
    const double t = 0.16 + 0.84 * (rank + 0.5) / ranks;
    Leaf leaf;
    leaf.base = stem.Point(t);
    const double around = stem.around + kGoldenAngle * rank * 1.7 + random.Uniform(-0.35, 0.35);
    leaf.direction = Around(around, 0.25 + 0.75 * t * t + random.Uniform(-0.15, 0.2));
    leaf.up = Around(around + kPi, kPi / 2 - 0.5).normalized();
    const double size = (1.05 - 0.45 * t) * random.Uniform(0.8, 1.15);
    leaf.length_mm = size * sizes.leaf_length_mm;
    leaf.width_mm = size * sizes.leaf_width_mm * random.Uniform(0.85, 1.15);
    leaf.droop = 1.15 - 0.35 * t + random.Uniform(-0.3, 0.3);
    leaf.curl = random.Uniform(0.15, 0.5);
    leaves.push_back(leaf);
  }
  return MakeLeaves(leaves, 0.35, LeafSegments(sizes.leaf_length_mm, edge_mm));
}

Shape MakeTree(PlantPart part, const TreeSizes& sizes, uint64_t seed, double edge_mm) {
  const std::vector<Branch> branches = Branches(sizes, seed);
  Shape shape;
  if (part == PlantPart::kStems) {
    for (const Branch& b : branches) {
      const int sides = std::clamp(static_cast<int>(2 * kPi * b.start_radius / edge_mm), 5, 20);
      // Reaches a little into the fork, so that no gap shows.
      AppendShape(shape,
                  MakeTube({b.from - 0.3 * b.start_radius * b.direction, b.to}, b.start_radius,
                           b.end_radius, sides),
                  V3::Zero());
    }
    return shape;
  }
  std::vector<Leaf> leaves;
  uint64_t count = 0;
  for (const Branch& b : branches) {
    if (b.level < sizes.levels) continue;
    for (int i = 0; i < sizes.leaves_per_twig; ++i) {
      RandomStream random(seed, 4, count++);
      Leaf leaf;
      leaf.base = b.from + (0.15 + 0.85 * (i + 1) / sizes.leaves_per_twig) * (b.to - b.from);
      const V3 axis = b.direction;
      const V3 out = Eigen::AngleAxisd(kGoldenAngle * i + random.Uniform(-0.3, 0.3), axis) *
                     axis.unitOrthogonal();
      leaf.direction = (out + random.Uniform(0.2, 0.8) * axis).normalized();
      leaf.up = (V3(0, 0, 1) + 0.3 * out).normalized();
      if (std::abs(leaf.up.dot(leaf.direction)) > 0.95) leaf.up = axis.unitOrthogonal();
      const double size = random.Uniform(0.7, 1.2);
      leaf.length_mm = size * sizes.leaf_length_mm;
      leaf.width_mm = size * sizes.leaf_width_mm;
      leaf.droop = random.Uniform(0.2, 0.9);
      leaf.curl = random.Uniform(0.1, 0.45);
      leaves.push_back(leaf);
    }
  }
  return MakeLeaves(leaves, 0.2, LeafSegments(sizes.leaf_length_mm, edge_mm));
}

}  // namespace lfm
