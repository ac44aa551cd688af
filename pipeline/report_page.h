// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pipeline/report_pictures.h"

namespace lfm {

/// Writes the report's page: plain HTML and SVG, nothing fetched from anywhere, every text escaped.
void WriteReportPage(const std::string& capture_name, const nlohmann::json& report,
                     const std::vector<ReportPicture>& pictures, const std::filesystem::path& file);

}  // namespace lfm
