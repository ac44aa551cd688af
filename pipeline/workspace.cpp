// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/workspace.h"

#include <algorithm>

#include "core/error.h"

namespace lfm {

int StageIndex(const std::string& name) {
  const auto it = std::find(kStages.begin(), kStages.end(), name);
  if (it == kStages.end()) {
    std::string names;
    for (const char* stage : kStages) names += (names.empty() ? "" : ", ") + std::string(stage);
    throw Error("there is no stage '" + name + "'; the stages are " + names);
  }
  return static_cast<int>(it - kStages.begin());
}

}  // namespace lfm
