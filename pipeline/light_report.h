// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "core/capture.h"
#include "core/progress.h"
#include "pipeline/workspace.h"

namespace lfm {

/// Writes `folder/report.json`, `folder/index.html` and `folder/pictures/` of a capture that varies
/// in light: a table of the methods on held-out lights, error against bytes, error against the
/// light's height, pictures beside each other with their differences; plain HTML and SVG. And
/// `folder/web/`: the model to be relit in a browser (viewer/relight_page.h), with at most 16
/// residual entries a row, which the page shows live;
/// left out where the model was changed since.
void WriteLightReport(const Capture& capture, const Workspace& workspace,
                      const std::filesystem::path& folder);

}  // namespace lfm
