// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sample_data/light_baking.h"
#include "sample_data/occluder.h"

namespace lfm {

/// Baked light with the shadow of an occluder: of every vertex and every node of the set, the share
/// of each lamp cell that the occluder hides is taken from what the cell gave (what is hidden by
/// both the scene and the occluder is taken to be independent within a cell). The occluder takes
/// nothing from the dim room and reflects nothing on the scene: a hand at 0.3 m hides less than a
/// tenth of a room that gives a small part of the light.
BakedLight ShadowLight(const BakedLight& light, const StudioScene& scene, const Subject& subject,
                       const Lighting& lighting, const Occluder& occluder);

}  // namespace lfm
