// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace lfm {

/// What printf would print, of any length.
std::string FormattedText(const char* format, ...) __attribute__((format(printf, 1, 2)));

}  // namespace lfm
