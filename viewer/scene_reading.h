// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "core/progress.h"
#include "viewer/scene.h"

namespace lfm {

/// Reads a scene's models, each file once however often it stands there; what is missing of one is
/// noted. Throws Error as ReadModel does.
Scene ReadScene(std::span<const SceneEntry> entries, Progress& progress);

}  // namespace lfm
