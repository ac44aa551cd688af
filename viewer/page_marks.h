// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace lfm {

/// Places in the pages that viewer/web/build.mjs makes, each there once.
constexpr std::string_view kTitleMark = "@LFM_TITLE@", kModelMark = "@LFM_MODEL_BASE64@",
                           kCameraMark = "@LFM_CAMERA@";  ///< of relighting only

/// The page with `text` in place of `mark`. Throws Error (kSystem) when it is not there.
std::string FillMark(std::string_view page, std::string_view mark, std::string_view text);

/// RFC 4648, with padding.
std::string Base64(std::string_view bytes);

}  // namespace lfm
