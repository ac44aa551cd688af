// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sample_data/scene_description.h"
#include "sample_data/shapes/shape_parameters.h"

namespace lfm {

/// Reads a scene file (docs/formats.md, "Scene files") and makes its meshes; `detail` scales the
/// resolution of generated shapes and nothing else. Files that it names are relative to its own
/// folder. The same file gives the same scene whatever the number of threads.
///
/// Throws Error, one line that names file and key: malformed JSON, a key that is missing or not
/// known, a value of another type, out of range or not finite, a file that is missing or cannot be
/// used, a shape that cannot be made, an object of a light field that leaves the platform (lower
/// than 0.5 mm below it, or farther than 75 mm from the axis in x or y: the tags begin at 81 mm).
SceneDescription LoadScene(const std::filesystem::path& json, SceneDetail detail);

/// A scene that is built into the program, by its name, or the file of that path: anything with a
/// '/' or the ending .json is a path. Throws Error that lists the names when there is no such
/// scene.
SceneDescription FindScene(const std::string& name_or_file, SceneDetail detail);

/// The scenes that are built in, in alphabetical order: sample_data/scenes/NAME.json.
std::vector<std::string> SceneNames();

}  // namespace lfm
