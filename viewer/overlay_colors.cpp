// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/overlay_colors.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/error.h"
#include "resample/direction_map.h"

namespace lfm {
namespace {

constexpr size_t kMostLegendEntries = 6;
const Eigen::Vector3f kNotKnown = {0.5f, 0.5f, 0.5f}, kNothing = {0.45f, 0.05f, 0.08f};
const Eigen::Vector3f kSeen = {0.2f, 0.65f, 0.3f}, kGuess = {0.9f, 0.25f, 0.15f};

// Five colours of rising lightness (as Matplotlib's viridis has them), straight lines between.
Eigen::Vector3f RisingColor(double share) {
  static const Eigen::Vector3f kStops[] = {{0.267f, 0.005f, 0.329f},
                                           {0.230f, 0.322f, 0.546f},
                                           {0.128f, 0.567f, 0.551f},
                                           {0.369f, 0.789f, 0.383f},
                                           {0.993f, 0.906f, 0.144f}};
  const double place = 4 * std::clamp(share, 0.0, 1.0);
  const int stop = std::min(static_cast<int>(place), 3);
  const auto rest = static_cast<float>(place - stop);
  return (1 - rest) * kStops[stop] + rest * kStops[stop + 1];
}

// Whole numbers as colours: 0 by itself, the others from the least to the most.
class CountColors {
 public:
  explicit CountColors(const std::vector<int>& counts) : different_(counts.begin(), counts.end()) {
    different_.erase(0);
  }
  Eigen::Vector3f operator()(int count) const {
    if (count == 0) return kNothing;
    const int least = *different_.begin(), most = *different_.rbegin();
    return RisingColor(most > least ? static_cast<double>(count - least) / (most - least) : 1);
  }
  std::vector<LegendEntry> Legend(const std::string& what, bool with_zero) const {
    std::vector<LegendEntry> legend;
    if (with_zero) legend.push_back({kNothing, "0 " + what});
    const std::vector<int> all(different_.begin(), different_.end());
    const size_t shown = std::min(all.size(), kMostLegendEntries);
    for (size_t i = 0; i < shown; ++i) {
      const int count = all[shown < 2 ? 0 : i * (all.size() - 1) / (shown - 1)];
      legend.push_back({(*this)(count), std::to_string(count) + " " + what});
    }
    return legend;
  }

 private:
  std::set<int> different_;
};

OverlayColors ColorsOfVertices(const LightFieldModel& model,
                               const std::vector<Eigen::Vector3f>& vertices) {
  OverlayColors colors;
  colors.corners.reserve(3 * model.mesh.triangles.size());
  for (const Eigen::Vector3i& triangle : model.mesh.triangles) {
    for (const int v : triangle) colors.corners.push_back(vertices[v]);
  }
  return colors;
}

OverlayColors ColorsOfCounts(const LightFieldModel& model, const std::vector<int>& counts,
                             const std::vector<int>& scale, const std::string& what) {
  const CountColors color(scale);
  std::vector<Eigen::Vector3f> vertices;
  vertices.reserve(counts.size());
  for (const int count : counts) vertices.push_back(color(count));
  OverlayColors colors = ColorsOfVertices(model, vertices);
  colors.legend = color.Legend(what, std::count(scale.begin(), scale.end(), 0) > 0);
  return colors;
}

OverlayColors NotKnown(const LightFieldModel& model, const std::string& why) {
  OverlayColors colors;
  colors.corners.assign(3 * model.mesh.triangles.size(), kNotKnown);
  colors.legend = {{kNotKnown, why}};
  return colors;
}

OverlayColors NormalColors(const LightFieldModel& model) {
  std::vector<Eigen::Vector3f> vertices;
  for (const Eigen::Matrix3d& frame : model.vertex_frames) {
    vertices.push_back(
        (0.5 * (frame.col(2) + Eigen::Vector3d::Ones())).cast<float>().cwiseMax(0).cwiseMin(1));
  }
  OverlayColors colors = ColorsOfVertices(model, vertices);
  colors.legend = {{{1, 0.5f, 0.5f}, "+x"}, {{0.5f, 1, 0.5f}, "+y"}, {{0.5f, 0.5f, 1}, "+z"}};
  return colors;
}

OverlayColors GuessedColors(const LightFieldModel& model, const Eigen::Vector3d& eye) {
  if (model.guessed.empty()) {
    return NotKnown(model, "this model does not say which directions are guessed");
  }
  std::vector<Eigen::Vector3f> vertices;
  vertices.reserve(model.vertex_frames.size());
  for (size_t v = 0; v < model.vertex_frames.size(); ++v) {
    const Eigen::Vector3d to_eye = (eye - model.mesh.vertices[v]).normalized();
    const Eigen::Vector2d square =
        SquareFromDirection(model.direction_map, model.vertex_frames[v].transpose() * to_eye);
    const Eigen::Vector2d texel =
        (square.cwiseMax(0.0).cwiseMin(1.0) * (model.grid - 1)).array().round();
    const int q = static_cast<int>(texel.y()) * model.grid + static_cast<int>(texel.x());
    vertices.push_back(model.IsGuessed(static_cast<int>(v), q) ? kGuess : kSeen);
  }
  OverlayColors colors = ColorsOfVertices(model, vertices);
  colors.legend = {{kSeen, "between photographs"}, {kGuess, "guessed from here"}};
  return colors;
}

OverlayColors PatchColors(const LightFieldModel& model, const std::vector<int>& all_counts) {
  std::vector<int> sizes;
  for (const PatchPlacement& placement : model.placements) sizes.push_back(placement.edge_samples);
  const CountColors color(all_counts.empty() ? sizes : all_counts);
  OverlayColors colors;
  for (const int size : sizes) colors.corners.insert(colors.corners.end(), 3, color(size));
  colors.legend = color.Legend("samples an edge", false);
  return colors;
}

}  // namespace

OverlayColors ColorsOf(Overlay overlay, const LightFieldModel& model, const OverlayData& data) {
  switch (overlay) {
    case Overlay::kNormals:
      return NormalColors(model);
    case Overlay::kPhotographs:
      if (data.photographs.size() != model.mesh.vertices.size()) {
        return NotKnown(model, "not known without --work");
      }
      return ColorsOfCounts(model, data.photographs, data.photographs, "photographs");
    case Overlay::kGuessed:
      return GuessedColors(model, data.eye);
    case Overlay::kTerms:
      return ColorsOfCounts(model, model.vertex_terms,
                            data.all_counts.empty() ? model.vertex_terms : data.all_counts,
                            "terms");
    case Overlay::kPatchSizes:
      return PatchColors(model, data.all_counts);
    case Overlay::kNone:
      break;
  }
  throw Error("there is no overlay to colour", ErrorKind::kSystem);
}

}  // namespace lfm
