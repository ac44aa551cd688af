// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace lfm::afx {

inline constexpr const char* kPictureFolder = "model_afx";

/// "mean-0" and a picture's bytes give "mean-0-1a2b3c4d5e6f.png": twelve digits of their hash.
/// Kinds are mean-, surface- and view-.
std::string PictureFile(const std::string& kind, std::string_view png);

/// Whether a file's name is one that PictureFile gives to some picture.
bool IsPictureFile(std::string_view file);

/// False where a path ends in a name that PictureFile gives to other bytes: pictures were swapped
/// or changed. Names of anybody else's say nothing.
bool FitsItsName(const std::string& path, std::string_view png);

}  // namespace lfm::afx
