// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "encode/model.h"

namespace lfm {

/// What is shown of a model instead of its light field.
enum class Overlay {
  kNone,
  kNormals,      ///< of the vertex frames: (x, y, z) from -1 to 1 as red, green, blue
  kPhotographs,  ///< how many photographs see each vertex
  kGuessed,      ///< vertices that no photograph saw from where the eye is
  kTerms,        ///< terms of each vertex
  kPatchSizes,   ///< samples along the edges of each triangle's patch
};

/// A colour and what it stands for.
struct LegendEntry {
  Eigen::Vector3f color;  ///< sRGB-coded
  std::string text;
};

/// Colours of all triangles' corners, and what they mean.
struct OverlayColors {
  std::vector<Eigen::Vector3f> corners;  ///< 3 T, sRGB-coded; as the triangles have their corners
  std::vector<LegendEntry> legend;
};

/// What the colours depend on beside the model.
struct OverlayData {
  std::vector<int> photographs;  ///< V, for kPhotographs (CountPhotographs); empty: not known
  Eigen::Vector3d eye = Eigen::Vector3d::Zero();  ///< in the model's frame, for kGuessed
  /// Of all models of a scene, for kTerms and kPatchSizes: their scale and legend; empty: this
  /// one's.
  std::vector<int> all_counts;
};

/// Counts are coloured from dark blue over green to yellow (0 is dark red), each different one
/// where there are few; guessed directions red, seen ones green, between them at a triangle's
/// corners a mixture. What is not known is gray. Not of Overlay::kNone (Error, kSystem).
OverlayColors ColorsOf(Overlay overlay, const LightFieldModel& model, const OverlayData& data);

/// Whether the colours change with the eye.
inline bool DependsOnEye(Overlay overlay) { return overlay == Overlay::kGuessed; }

}  // namespace lfm
