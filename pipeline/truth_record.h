// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "core/capture.h"
#include "pipeline/workspace.h"

namespace lfm {

/// Hashes of everything that a comparison with the truth looks at: the workspace's poses, points,
/// meshes and model, and the test photographs. To be taken before the comparison begins.
nlohmann::json TruthInputs(const Capture& capture, const Workspace& workspace);

/// Keeps what EvaluateWithTruth found in `WORK/truth/truth.json` (docs/formats.md), with `inputs`.
void SaveTruth(const Workspace& workspace, const nlohmann::json& inputs,
               const nlohmann::json& result);

/// What SaveTruth kept; no answer when there is none, when it is damaged, or when it was found for
/// other poses, points, meshes, photographs or another model than lie there now.
std::optional<nlohmann::json> FindTruth(const Capture& capture, const Workspace& workspace);

}  // namespace lfm
