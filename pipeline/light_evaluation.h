// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/progress.h"
#include "fields/field_reading.h"
#include "fields/relightable_model.h"
#include "pipeline/workspace.h"

namespace lfm {

/// The `evaluate` figures of a capture that varies in light: `relightable` with rising numbers of
/// residuals, the training pictures themselves and the classic fits, on the held-out lights
/// (fields/heldout_lights.h). `pictures`, when not empty, gets held-out pictures beside what is
/// shown for them, listed under "pictures" with captions.
///
/// "heldout_psnr_db" and its like are those of the model with all residuals. Without held-out
/// lights a "note" says so. Throws Error when the model is not one of the training lights' field.
nlohmann::json EvaluateLights(const ReflectanceFieldData& data, const RelightableModel& relightable,
                              const std::filesystem::path& pictures, Progress& progress);

/// The same of a workspace that RunLightPipeline filled, or of another .lfr file (`model`) of the
/// same capture.
nlohmann::json EvaluateLightWorkspace(const std::filesystem::path& capture,
                                      const Workspace& workspace,
                                      const std::filesystem::path& model, Progress& progress);

}  // namespace lfm
