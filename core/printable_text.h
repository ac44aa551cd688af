// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

// Private to core.

namespace lfm {

/// `text` as a terminal may be given it: UTF-8 as it is, line ends as spaces, and every other byte
/// (control characters, what is no UTF-8) as \xNN.
std::string PrintableText(std::string_view text);

}  // namespace lfm
