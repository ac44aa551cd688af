// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "core/progress.h"
#include "pipeline/workspace.h"

namespace lfm {

/// Writes `folder/report.json`, `folder/index.html` and `folder/pictures/` of a capture that varies
/// in light: a table of the methods on held-out lights, error against bytes, error against the
/// light's height, pictures beside each other with their differences. Plain HTML and SVG.
void WriteLightReport(const std::string& capture_name, const Workspace& workspace,
                      const std::filesystem::path& folder);

}  // namespace lfm
