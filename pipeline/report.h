// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/capture.h"
#include "core/progress.h"
#include "pipeline/workspace.h"

namespace lfm {

/// All figures of a workspace as nested objects (docs/formats.md, report.json): one object a stage,
/// `time`, `memory`, and `truth` once lfm-evaluate --ground-truth has run. When it has, for what
/// lies in the workspace now, `evaluate` is counted over the true masks.
///
/// A stage whose results are no longer those that its record describes (its own command has run
/// since) shows no figures but `out_of_date`, which says what to do.
nlohmann::json CollectReport(const Capture& capture, const Workspace& workspace);

/// Writes `folder/report.json`, `folder/index.html`, `folder/pictures/` and `folder/web/`: every
/// stage's figures and pictures on one page, and the model for browsers (viewer/web_page.h), which
/// the page shows.
void WriteReport(const Capture& capture, const Workspace& workspace,
                 const std::filesystem::path& folder, Progress& progress);

}  // namespace lfm
