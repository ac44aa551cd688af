// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "encode/encode.h"

namespace lfm {

/// Writes `folder/model.glb`, `folder/model.lfz` (removed where the result has none) and
/// `folder/encode.json` (the figures, with model_bytes), each
/// atomically. Returns the figures.
nlohmann::json SaveEncode(const EncodeResult& result, const std::filesystem::path& folder);
/// Reads both back, model_bytes set. Throws Error when one is missing or damaged.
EncodeResult LoadEncode(const std::filesystem::path& folder);

}  // namespace lfm
