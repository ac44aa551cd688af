// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "encode/glb_document.h"
#include "encode/model.h"

namespace lfm::glb {

/// Reads where patches and tiles lie, from one placement a triangle or from codebooks. Mesh and
/// terms of `model` must have been read. Throws Error; what lies outside its page is left to
/// ValidateModel.
void ReadPlaces(const Document& doc, const nlohmann::json& extension, LightFieldModel& model);

/// Reads pages in blocks, `max_texels` in all at most, as they are.
void ReadBlocks(const Document& doc, const nlohmann::json& blocks, int64_t max_texels,
                LightFieldModel& model);
/// Makes pages of all blocks that `model` has.
void DecodeBlocks(LightFieldModel& model);

}  // namespace lfm::glb
