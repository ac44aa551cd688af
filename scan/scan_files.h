// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "scan/scan.h"

namespace lfm {

/// Writes `folder/rig.json`, `folder/scan_NN.ply` and `folder/points.ply`.
void SaveScan(const ScanResult& result, const std::filesystem::path& folder);
/// Reads rig and clouds back.
ScanResult LoadScan(const std::filesystem::path& folder);

}  // namespace lfm
