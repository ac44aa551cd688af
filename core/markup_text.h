// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace lfm {

/// Text as it stands in HTML, SVG or XML, in an element or in an attribute in double quotes.
std::string EscapeMarkup(std::string_view text);

}  // namespace lfm
