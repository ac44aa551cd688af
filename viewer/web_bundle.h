// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

/// What viewer/web/build.mjs makes of viewer/web, held by the program.
namespace lfm::web_bundle {

std::string_view AppJs();
std::string_view IndexHtml();
std::string_view SingleHtml();  ///< with places for the title and for the model in base 64

/// The same for models that are to be relit, with a place for the camera.
std::string_view RelightAppJs();
std::string_view RelightIndexHtml();
std::string_view RelightSingleHtml();

}  // namespace lfm::web_bundle
