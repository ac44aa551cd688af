// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "encode/model.h"

namespace lfm::testing {

/// Each target's own: gives bytes to a reader and uses what comes back. Bytes that are no file of
/// the format end in lfm::Error; anything else that is thrown, and whatever the sanitizers see, is
/// a find.
void FuzzOne(std::span<const uint8_t> bytes);

/// Looks at a model that was read: some points of every triangle from some directions.
void UseModel(const LightFieldModel& model);

}  // namespace lfm::testing
