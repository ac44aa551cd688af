// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace lfm {

/// Writes a model for browsers (viewer/web) into `folder`, which is made where it is missing:
///
///   model.html               everything in one file, which opens from disk
///   index.html, app.js       the same for a web server of static files, with
///   model.glb                the model beside them, shown while it arrives
///
/// `glb` is a whole model.glb, `title` plain text. All files are written, or none: a full disk is
/// an Error (kSystem). The pages fetch nothing else, and scripts of others do not run in them
/// (Content-Security-Policy).
void WriteWebFolder(std::string_view glb, const std::string& title,
                    const std::filesystem::path& folder);

/// RFC 4648, with padding.
std::string Base64(std::string_view bytes);

}  // namespace lfm
