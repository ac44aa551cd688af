// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>

namespace lfm {

/// The text of every sample_data/scenes/NAME.json by NAME, as it was when the program was built
/// (cmake/EmbedScenes.cmake writes the source).
const std::map<std::string, std::string>& BuiltinSceneTexts();

}  // namespace lfm
