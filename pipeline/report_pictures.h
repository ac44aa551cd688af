// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/capture.h"
#include "core/progress.h"
#include "pipeline/workspace.h"

namespace lfm {

/// One picture of the report.
struct ReportPicture {
  std::string stage;    ///< the section that shows it
  std::string file;     ///< relative to the report's folder
  std::string caption;  ///< what to look for
};

/// Draws every stage's pictures into `folder`.
std::vector<ReportPicture> MakeReportPictures(const Capture& capture, const Workspace& workspace,
                                              const std::filesystem::path& folder,
                                              Progress& progress);

}  // namespace lfm
