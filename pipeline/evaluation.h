// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/capture.h"
#include "core/progress.h"
#include "pipeline/workspace.h"

namespace lfm {

/// The `evaluate` figures of a workspace: its model against the capture's test photographs, over
/// the silhouette of its dense surface (DESIGN 2).
/// `model`, when not empty, is scored in place of the workspace's own: a .glb, .lfz or .wrl file of
/// the same object in the same frame.
nlohmann::json EvaluateWorkspace(const Capture& capture, const Workspace& workspace,
                                 Progress& progress, const std::filesystem::path& model = {});

/// The figures that need the truth: {"truth": {...}, "evaluate": {...}}, the latter over the true
/// masks. Opens `CAPTURE/ground_truth`.
nlohmann::json EvaluateWithTruth(const Capture& capture, const Workspace& workspace,
                                 Progress& progress);

/// The `truth` figures of cameras, points and surfaces alone, of the stages that have run: no model
/// is needed. Opens `CAPTURE/ground_truth`; throws Error when cameras are missing.
nlohmann::json EvaluateGeometry(const Capture& capture, const Workspace& workspace,
                                Progress& progress);

/// Which pixels count.
enum class Foreground { kSurfaceSilhouette, kTrueMask };

/// Scores pictures `images/ID.png` (or .jpg), one for every test photograph, by the same rule as
/// the model. A missing or differently sized picture is an Error that names it.
nlohmann::json EvaluateImages(const Capture& capture, const Workspace& workspace,
                              const std::filesystem::path& images, Foreground foreground,
                              Progress& progress);

}  // namespace lfm
