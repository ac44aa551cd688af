// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/shapes/shape_generators.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>

#include "core/error.h"
#include "sample_data/bust_shape.h"
#include "sample_data/shapes/box_shape.h"
#include "sample_data/shapes/dancer_shape.h"
#include "sample_data/shapes/head_shape.h"
#include "sample_data/shapes/helmet_shape.h"
#include "sample_data/shapes/knight_shape.h"
#include "sample_data/shapes/lathe_shape.h"
#include "sample_data/shapes/plant_shape.h"
#include "sample_data/shapes/round_shape.h"
#include "sample_data/shapes/star_shape.h"
#include "sample_data/shapes/statue_shape.h"
#include "sample_data/shapes/turtle_shape.h"
#include "sample_data/subject.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;
using P = ShapeParameters;

constexpr double kMaxSize = 1e4;  // mm

uint64_t Seed(P& p) { return static_cast<uint64_t>(p.Integer("seed", 1, 0, 1'000'000'000)); }

// Reads a shape's parameters; what it returns makes the shape.
using Maker = std::function<Shape()>;

Maker Bust(P& p) {
  const double edge = p.Edge(0.55, 2.5);
  const uint64_t seed = Seed(p);
  return [=] {
    Subject subject = MakeBust(edge, seed);
    return Shape{std::move(subject.mesh), {}, std::move(subject.paint)};
  };
}

Maker Dancer(P& p) {
  const double edge = p.Edge(0.5, 1.3);
  const uint64_t seed = Seed(p);
  return [=] { return MakeDancer(edge, seed); };
}

Maker Statue(P& p) {
  const double edge = p.Edge(0.8, 2.5);
  return [=] { return MakeStatue(edge); };
}

Maker Head(P& p) {
  const HeadPart part = static_cast<HeadPart>(p.Choice("part", {"skin", "hair"}, 0));
  const double edge = p.Edge(0.8, 3);
  return [=] { return MakeHead(part, edge); };
}

Maker Turtle(P& p) {
  const int part = p.Choice("part", {"body", "shell", "belly", "eyes"}, 0);
  const bool eyes = part == static_cast<int>(TurtlePart::kEyes);
  const double edge = p.Edge(0.6, eyes ? 1.2 : 3);
  return [=] { return MakeTurtle(static_cast<TurtlePart>(part), edge); };
}

Maker Star(P& p) {
  StarSizes sizes;
  sizes.arms = p.Integer("arms", sizes.arms, 3, 12);
  sizes.tip_mm = p.Number("tip_mm", sizes.tip_mm, 1, kMaxSize);
  sizes.notch_mm = p.Number("notch_mm", sizes.notch_mm, 0.5, kMaxSize);
  sizes.half_depth_mm = p.Number("half_depth_mm", sizes.half_depth_mm, 0.2, kMaxSize);
  sizes.half_rim_mm = p.Number("half_rim_mm", sizes.half_rim_mm, 0.1, kMaxSize);
  sizes.bevel_mm = p.Number("bevel_mm", sizes.bevel_mm, 0.01, 100);
  const double edge = p.Edge(0.5, 2.5);
  return [=] { return MakeStar(sizes, edge); };
}

Maker Helmet(P& p) {
  const int part = p.Choice("part", {"steel", "brass"}, 0);
  const double edge = p.Edge(0.7, part == 0 ? 1.6 : 1.2);
  return [=] { return MakeHelmet(static_cast<HelmetPart>(part), edge); };
}

Maker Knight(P& p) {
  const int part =
      p.Choice("part", {"armour", "mail", "cloth", "cape", "skin", "shield", "sword", "base"}, 0);
  const KnightPart kind = static_cast<KnightPart>(part);
  const bool fine = kind == KnightPart::kSkin || kind == KnightPart::kSword;
  const double edge = p.Edge(fine ? 0.4 : 0.6, fine ? 1.0 : 1.2);
  return [=] { return MakeKnight(kind, edge); };
}

Maker Plant(P& p) {
  PlantSizes sizes;
  const PlantPart part = static_cast<PlantPart>(p.Choice("part", {"leaves", "stems"}, 0));
  sizes.stem_count = p.Integer("stems", sizes.stem_count, 1, 100);
  sizes.leaf_count = p.Integer("leaves", sizes.leaf_count, 1, 5000);
  sizes.height_mm = p.Number("height_mm", sizes.height_mm, 1, kMaxSize);
  sizes.leaf_length_mm = p.Number("leaf_length_mm", sizes.leaf_length_mm, 1, kMaxSize);
  sizes.leaf_width_mm = p.Number("leaf_width_mm", sizes.leaf_width_mm, 0.5, kMaxSize);
  const uint64_t seed = Seed(p);
  const double edge = p.Edge(2, 6);
  return [=] { return MakePlant(part, sizes, seed, edge); };
}

Maker Tree(P& p) {
  TreeSizes sizes;
  const PlantPart part = static_cast<PlantPart>(p.Choice("part", {"leaves", "stems"}, 0));
  sizes.levels = p.Integer("levels", sizes.levels, 1, 8);
  sizes.leaves_per_twig = p.Integer("leaves_per_twig", sizes.leaves_per_twig, 1, 50);
  sizes.height_mm = p.Number("height_mm", sizes.height_mm, 1, kMaxSize);
  sizes.trunk_radius_mm = p.Number("trunk_radius_mm", sizes.trunk_radius_mm, 0.1, kMaxSize);
  sizes.leaf_length_mm = p.Number("leaf_length_mm", sizes.leaf_length_mm, 0.5, kMaxSize);
  sizes.leaf_width_mm = p.Number("leaf_width_mm", sizes.leaf_width_mm, 0.2, kMaxSize);
  const uint64_t seed = Seed(p);
  const double edge = p.Edge(1.5, 4);
  return [=] { return MakeTree(part, sizes, seed, edge); };
}

Maker Box(P& p) {
  const V3 size = p.Vector("size_mm", {20, 20, 20}, 0.05, kMaxSize);
  const double bevel = p.Number("bevel_mm", 0.04 * size.minCoeff(), 1e-4, kMaxSize);
  const double edge = p.Edge(size.maxCoeff(), size.maxCoeff());
  return [=] { return MakeBox(size, bevel, edge); };
}

Maker RingWall(P& p) {
  const double inner = p.Number("inner_radius_mm", 50, 0.1, kMaxSize);
  const double outer = p.Number("outer_radius_mm", 54, 0.1, kMaxSize);
  const double height = p.Number("height_mm", 40, 0.1, kMaxSize);
  const double angle = p.Number("angle_deg", 180, 1, 359) * std::numbers::pi / 180;
  const double bevel = p.Number("bevel_mm", 0.4, 1e-4, kMaxSize);
  const double edge = p.Edge(4, 8);
  return [=] { return MakeRingWall(inner, outer, height, angle, bevel, edge); };
}

Maker Sheet(P& p) {
  const double width = p.Number("width_mm", 100, 0.1, kMaxSize);
  const double depth = p.Number("depth_mm", 100, 0.1, kMaxSize);
  const double longest = std::max(width, depth);
  const double edge = p.Edge(longest / 20, longest / 8);
  return [=] { return MakeSheet(width, depth, edge); };
}

Maker Blockers(P& p) {
  const int count_x = p.Integer("count_x", 8, 1, 200), count_y = p.Integer("count_y", 1, 1, 200);
  const V3 size = p.Vector("size_mm", {4, 100, 10}, 0.05, kMaxSize);
  const Eigen::Vector2d pitch(p.Number("pitch_x_mm", 2 * size.x(), 0.05, kMaxSize),
                              p.Number("pitch_y_mm", 2 * size.y(), 0.05, kMaxSize));
  const double bevel = p.Number("bevel_mm", 0.02 * size.minCoeff(), 1e-4, kMaxSize);
  const double edge = p.Edge(size.maxCoeff(), size.maxCoeff());
  return [=] { return MakeBlockers(count_x, count_y, size, pitch, bevel, edge); };
}

Maker EllipsoidShape(P& p) {
  const V3 radii = p.Vector("radii_mm", {50, 50, 50}, 0.05, kMaxSize);
  const double longest = radii.maxCoeff();
  const double edge = p.Edge(longest / 40, longest / 10);
  return [=] { return MakeEllipsoid(radii, edge); };
}

Maker Hemisphere(P& p) {
  const double radius = p.Number("radius_mm", 50, 0.05, kMaxSize);
  const double edge = p.Edge(radius / 60, radius / 10);
  return [=] { return MakeHemisphere(radius, edge); };
}

Maker Bowl(P& p) {
  const double radius = p.Number("radius_mm", 50, 0.05, kMaxSize);
  const double thickness = p.Number("thickness_mm", 0.06 * radius, 0.01, kMaxSize);
  const double edge = p.Edge(radius / 60, radius / 10);
  return [=] { return MakeBowl(radius, thickness, edge); };
}

Maker Lathe(P& p) {
  const std::vector<Eigen::Vector2d> profile = p.Points("profile_mm");
  const double rounding = p.Number("rounding_mm", 0.5, 1e-4, kMaxSize);
  Flutes flutes;
  flutes.count = p.Integer("flutes", 0, 0, 200);
  if (flutes.count > 0) {
    flutes.depth_mm = p.Number("flute_depth_mm", 0.5, 0.01, kMaxSize);
    flutes.low_mm = p.Number("flute_low_mm", 0, -kMaxSize, kMaxSize);
    flutes.high_mm = p.Number("flute_high_mm", 0, -kMaxSize, kMaxSize);
  }
  const double edge = p.Edge(1, 4);
  return [=] { return MakeLathe(profile, rounding, edge, flutes); };
}

const std::map<std::string, Maker (*)(P&)>& Generators() {
  static const std::map<std::string, Maker (*)(P&)> generators = {
      {"blockers", Blockers},  {"bowl", Bowl},     {"box", Box},
      {"bust", Bust},          {"dancer", Dancer}, {"ellipsoid", EllipsoidShape},
      {"head", Head},          {"helmet", Helmet}, {"hemisphere", Hemisphere},
      {"knight", Knight},      {"lathe", Lathe},   {"plant", Plant},
      {"ring-wall", RingWall}, {"sheet", Sheet},   {"star", Star},
      {"statue", Statue},      {"tree", Tree},     {"turtle", Turtle}};
  return generators;
}

}  // namespace

Shape GenerateShape(JsonReader& reader, SceneDetail detail) {
  const std::string name = reader.Text("generator");
  const auto found = Generators().find(name);
  if (found == Generators().end()) {
    std::string all;
    for (const std::string& known : ShapeGeneratorNames()) all += (all.empty() ? "" : ", ") + known;
    reader.Fail("generator", "there is no shape '" + name + "'; there are " + all);
  }
  ShapeParameters parameters(reader, detail);
  const Maker make = found->second(parameters);
  reader.Finish();
  try {
    return make();
  } catch (const Error& e) {
    reader.Fail("", e.what());
  }
}

std::vector<std::string> ShapeGeneratorNames() {
  std::vector<std::string> names;
  for (const auto& [name, generator] : Generators()) names.push_back(name);
  return names;
}

}  // namespace lfm
