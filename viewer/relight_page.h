// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace lfm {

/// Writes a model for relighting (fields/relightable_file.h), of a picture, for browsers
/// (viewer/web/relight) into `folder`, which is made where it is missing:
///
///   relight.html          everything in one file, which opens from disk
///   index.html, app.js    the same for a web server of static files, with
///   model.lfr             the model beside them
///
/// `lfr` is the whole file; its content is checked by the page, which says what it cannot show
/// (vertices of a mesh, directions towards the eye). `title` is plain text. `camera_from_world`:
/// the rotation of the picture's camera (x right, y down, z forward), by which the page knows where
/// in the picture a light of the world lies; without it x is to the right, y up, and z towards the
/// viewer. All files are written, or none: a full disk is an Error (kSystem). The pages fetch
/// nothing else, and scripts of others do not run in them (Content-Security-Policy). Throws Error
/// when the model is empty or the rotation is none (to 1e-6).
void WriteRelightPages(std::string_view lfr, const std::string& title,
                       const std::filesystem::path& folder,
                       const std::optional<Eigen::Matrix3d>& camera_from_world = std::nullopt);

}  // namespace lfm
