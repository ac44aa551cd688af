// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

namespace lfm {

/// Asks, before long work, whether results can be written into `folder`, and changes nothing: a
/// folder is made, and removed again, in `folder` or, where it does not exist, in the nearest one
/// above that does. An empty path is the current folder. Throws Error, naming the culprit, when a
/// file is in the way or the system lets nothing be made there; of kSystem when the disk is full.
void RequireWritableFolder(const std::filesystem::path& folder);

}  // namespace lfm
