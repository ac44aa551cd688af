// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "viewer/viewer_state.h"
#include "viewer/viewer_status.h"

namespace lfm {

/// Sets what a script names, "terms 2": a name and its value (docs/formats.md). Numbers are as the
/// panel's sliders take them. Throws Error that names the setting and what it may be.
ViewerState SetByName(ViewerState state, const std::string& setting);
/// The names that SetByName knows.
std::vector<std::string> SettingNames();

/// What the viewer shows and knows, for scripts (docs/formats.md).
nlohmann::json StateToJson(const ViewerState& state, const ViewerStatus& status);

}  // namespace lfm
