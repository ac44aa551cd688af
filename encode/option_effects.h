// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

#include "encode/encode.h"

namespace lfm {

/// Throws Error for an option of EncodeOptions that was given though the others leave it without
/// effect (--vq-start without codebooks); the message names both. `given` says, by an option's
/// name, whether somebody asked for it: a preset that sets one asks for nothing.
void RequireEffect(const EncodeOptions& options,
                   const std::function<bool(const std::string& name)>& given);

}  // namespace lfm
