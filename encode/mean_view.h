// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/progress.h"
#include "encode/light_field_source.h"
#include "encode/shared_samples.h"

namespace lfm {

/// The mean view of every triangle as 8-bit sRGB codes: `codes[t][sample * 3 + channel]`.
struct MeanView {
  std::vector<std::vector<uint8_t>> codes;
  int unseen_triangles = 0;  ///< filled from their neighbours
};

/// The mean of each sample over the view grids of the triangle's three corners; directions that
/// were guessed count `guessed_weight` (1 where none was seen). Edges and corners are then made
/// continuous (MakeContinuous), codes too. Triangles that no photograph sees are filled smoothly
/// from their neighbours. In cells on the hypotenuse whose completion b + c - a (gutters.h) would
/// leave [0, 1], the sample a is moved by what is lacking, to a level or so.
///
/// Throws Error when no triangle at all is seen, or the source is inconsistent.
MeanView ComputeMeanView(const LightFieldSource& source, const SharedSamples& shared,
                         double guessed_weight, Progress& progress);

/// 8-bit codes of mean views (3 values a sample, sRGB-coded) that are equal on shared samples and
/// whose completions stay in range, as above. `measured`: patches that give their neighbours values
/// (PatchValues).
std::vector<std::vector<uint8_t>> ContinuousMeanCodes(const SharedSamples& shared,
                                                      std::span<const int> edge_samples,
                                                      std::span<const uint8_t> measured,
                                                      std::vector<std::vector<float>> means);

/// Colours for vertices that are not `known` (sRGB-coded RGB), spread from those that are along
/// the mesh's edges and smoothed; parts without any known vertex take the mean of all known ones.
/// Nothing known: all stay as they are.
std::vector<Eigen::Vector3f> SpreadVertexColors(const TriangleMesh& mesh,
                                                std::vector<Eigen::Vector3f> colors,
                                                std::vector<uint8_t> known);

}  // namespace lfm
