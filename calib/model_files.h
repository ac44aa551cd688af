// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "calib/calib.h"
#include "core/json_reader.h"

// The chosen models in cameras.json and platform.json. Private to calib_files.

namespace lfm {

/// Adds "lens_trials" and "intrinsics_covariance" to cameras.json.
void LensModelsToJson(const CalibResult& result, nlohmann::json& cameras);
/// The inverse, after `cameras` and `lens_terms` were read. Throws Error for cameras that are not
/// listed, models that do not exist, covariances of another size than the lens terms ask for.
void LensModelsFromJson(JsonReader& reader, CalibResult& result);

/// platform.json: the model, the trials behind it, the shape.
nlohmann::json PlatformToJson(const CalibResult& result);
/// The inverse; throws Error on missing, malformed, non-finite content.
void LoadPlatform(const std::filesystem::path& file, CalibResult& result);

}  // namespace lfm
