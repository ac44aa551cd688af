// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "core/progress.h"
#include "encode/encode.h"
#include "encode/light_field_source.h"
#include "encode/map_selection.h"
#include "encode/model.h"
#include "encode/model_error.h"

namespace lfm {

/// Throws Error when no model of these patches is as small as options.target_mb: before anything is
/// factorised.
void RequireRoomForMeanView(const LightFieldSource& source, std::span<const int> edge_samples,
                            const EncodeOptions& options);

/// Terms and resolutions as the options ask for them: all, by gain, by tolerance, or by a target (a
/// PSNR as estimated; bytes as laid out). Notes when a PSNR is out of reach.
MapSelection ChooseMaps(const LightFieldSource& source, std::span<const int> edge_samples,
                        const MapCosts& costs, const EncodeOptions& options, Progress& progress);

/// A model of coarser maps, and what it loses with its first 0, 1, ... terms.
struct Coarsened {
  MapSelection maps;
  LightFieldModel model;
  std::vector<ModelError> errors;
};

/// The model of `first`, coarsened. What resolutions lose is estimated; against a PSNR asked for it
/// is measured, and allowed for in up to three more trials; notes when none of them reaches it.
/// `whole` makes the model with so many terms a vertex, every sample of them.
Coarsened CoarsenToTarget(
    const LightFieldSource& source, const MapCosts& costs, const EncodeOptions& options,
    const MapSelection& first,
    const std::function<LightFieldModel(const std::vector<int>& terms)>& whole, Progress& progress);

}  // namespace lfm
