// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

namespace lfm {

/// Throws Error when the machine has not the memory that FunctionRows of this size take: `name` in
/// front, `cure` (what to do beside freeing memory) behind. Sizes out of range for FunctionRows are
/// left to MakeFunctionRows.
void RequireRoom(int64_t rows, int64_t columns, const std::string& name, const std::string& cure);

}  // namespace lfm
