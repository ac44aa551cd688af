// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "encode/factored_operator.h"
#include "encode/map_quantization.h"
#include "encode/model.h"

namespace lfm {

/// Every second sample of a patch of n samples an edge, n odd and at least 5: (n + 1) / 2 remain.
/// `values` holds one number a sample.
std::vector<float> HalvePatch(std::span<const float> values, int n);
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
