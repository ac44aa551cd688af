// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "encode/light_field_source.h"
#include "encode/model.h"

namespace lfm {

/// How far a model is from a resampled light field.
struct ModelError {
  double squared_error = 0;
  int64_t entries = 0;
  double psnr_db() const;  ///< of 1.0; 99 at most
};

/// Over all vertex matrices, as EncodeResult::matrix_psnr_db, and with the model's own mean view,
/// so that its errors count too: what the maps of a model are worth that was coded and decoded
/// since (its coordinates and frames may have been rounded: not seen here). Mesh, patches and view
/// grid must be those of the source, in the same order; throws Error where they are not.
ModelError CompareWithLightField(const LightFieldSource& source, const LightFieldModel& model);
/// The same with the first 0, 1, ... of each vertex's terms: one more than the model has.
std::vector<ModelError> CompareByTerms(const LightFieldSource& source,
                                       const LightFieldModel& model);

}  // namespace lfm
