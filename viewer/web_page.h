// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "viewer/scene.h"

namespace lfm {

/// A model of a page.
struct WebModel {
  std::string_view glb;  ///< a whole model.glb
  Placement placement;
};

/// Writes a scene for browsers (viewer/web) into `folder`, which is made where it is missing:
///
///   model.html                         everything in one file, which opens from disk
///   index.html, app.js                 the same for a web server of static files, with
///   model.glb, model-2.glb, ...        the models beside them, shown while they arrive, and
///   scene.json                         where they stand, as ReadSceneFile reads it; not of one
///                                      model that stands where it is
///
/// Models of equal bytes are one file. Where earlier pages lie in the folder, models that they had
/// more go. `title` is plain text. All files are written, or none: a
/// full disk is an Error (kSystem). The pages fetch nothing else, and scripts of others do not run
/// in them (Content-Security-Policy). Throws Error when there is no model, more than 1000, or a
/// placement that ReadSceneFile would refuse.
void WriteWebFolder(std::span<const WebModel> models, const std::string& title,
                    const std::filesystem::path& folder);
/// The same for one model where it is.
void WriteWebFolder(std::string_view glb, const std::string& title,
                    const std::filesystem::path& folder);

}  // namespace lfm
