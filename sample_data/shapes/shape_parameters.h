// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/json_reader.h"

namespace lfm {

/// How fine a scene's shapes are: coarse for quick tests, or as the scene asks.
enum class SceneDetail { kTiny, kDefault };

/// The parameters of a shape in a scene file, with their ranges and defaults. Throws Error (file,
/// key, what was expected) for a value of another type or out of range.
class ShapeParameters {
 public:
  ShapeParameters(JsonReader& reader, SceneDetail detail) : reader_(&reader), detail_(detail) {}

  double Number(const std::string& key, double otherwise, double min, double max);
  int Integer(const std::string& key, int otherwise, int min, int max);
  /// Index of a word in `words`.
  int Choice(const std::string& key, const std::vector<std::string>& words, int otherwise);
  /// Three numbers in [min, max].
  Eigen::Vector3d Vector(const std::string& key, const Eigen::Vector3d& otherwise, double min,
                         double max);
  /// Points (radius, z) of a profile; none when the key is missing.
  std::vector<Eigen::Vector2d> Points(const std::string& key);
  /// Length of edges: "edge_mm" (default `otherwise`), or for kTiny "tiny_edge_mm" (default `tiny`,
  /// never finer than "edge_mm").
  double Edge(double otherwise, double tiny);

 private:
  double InRange(const std::string& key, double value, double min, double max) const;
  JsonReader* reader_;
  SceneDetail detail_;
};

}  // namespace lfm
