// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "scan/scan.h"

namespace lfm {

/// For people, a line each: what held the scans' poses beside the platform (turntable runs, whether
/// the registration's poses were kept), and a warning when the projector explains its patterns
/// worse than rigs do.
std::vector<std::string> DescribeScans(const ScanResult& result);

}  // namespace lfm
