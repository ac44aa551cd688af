// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "core/json_reader.h"
#include "sample_data/material.h"
#include "sample_data/scene_description.h"

namespace lfm {

/// The "material" of a scene file's object. Each kind knows its own keys alone; colours lie in
/// [0, 1], and what is given must not reflect more than arrives (docs/formats.md). Throws Error
/// (file, key, what was expected).
Material ReadMaterial(JsonReader reader);

/// The "texture" of a scene file's object. A picture's path is relative to `folder`; empty where
/// there are no files (scenes that are built in). Throws Error as ReadMaterial does, and for a
/// picture that cannot be read or is neither gray nor RGB.
Texture ReadTexture(JsonReader reader, const std::filesystem::path& folder);

/// A number in [min, max], or `otherwise` when the key is missing.
double NumberInRange(JsonReader& reader, const std::string& key, double otherwise, double min,
                     double max);
/// Three of them.
Eigen::Vector3d VectorInRange(JsonReader& reader, const std::string& key,
                              const Eigen::Vector3d& otherwise, double min, double max);
/// The index of the text under `key` in `words`; Error that lists them when it is none.
int WordIndex(JsonReader& reader, const std::string& key, const std::vector<std::string>& words);
/// A file named by the text under `key`, relative to `folder`. Error when it does not exist.
std::filesystem::path ExistingFile(JsonReader& reader, const std::string& key,
                                   const std::filesystem::path& folder);

}  // namespace lfm
