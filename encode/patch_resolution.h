// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "encode/factored_operator.h"
#include "encode/map_quantization.h"
#include "encode/model.h"

namespace lfm {

/// Samples an edge of the next coarser resolution: every second, or else every third; 0 where
/// neither divides n - 1, and for n = 2.
int CoarserEdgeSamples(int n);
/// The resolutions that a patch of n may have, finest first: n, the next coarser, and so on.
std::vector<int> EdgeSampleLevels(int n);
/// The samples of a patch of `from` samples an edge that one of `to` has too; to - 1 must divide
/// from - 1. `values` holds one number a sample.
std::vector<float> SubsamplePatch(std::span<const float> values, int from, int to);
std::vector<uint8_t> SubsamplePatch(std::span<const uint8_t> values, int from, int to);
/// The samples of a patch of `to` samples an edge where one of `from` is interpolated as
/// EvaluateModel does: bilinearly, and linearly in the cells on the hypotenuse. Equal sizes give
/// the same values.
std::vector<float> InterpolatePatch(std::span<const float> values, int from, int to);

/// ReadMean (in [0, 1]) and ReadVertexTerm with as many samples as the light field has, where a
/// model's patches have fewer. Interpolated codes of surface maps are rounded.
PatchMean MeanAtResolution(const LightFieldModel& model, int triangle, int n);
TermMaps TermAtResolution(const LightFieldModel& model, const VertexOperator& f,
                          std::span<const int> ring, int vertex, int term);

}  // namespace lfm
