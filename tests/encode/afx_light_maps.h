// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>

#include "encode/model.h"

namespace lfm::testing {

/// A model of AFX form with three light maps a term, as other writers may split one: every third
/// vertex has maps of half the range, every other third of a quarter.
inline LightFieldModel WithThreeLightMaps(LightFieldModel form) {
  constexpr float kShares[] = {1, 0.5F, 0.25F};
  const size_t vertices = form.vertex_terms.size();
  for (size_t i = 0; i < form.surface_ranges.size(); ++i) {
    for (MapRange* range : {&form.surface_ranges[i], &form.view_ranges[i]}) {
      range->scale *= kShares[i % vertices % 3];
      range->bias *= kShares[i % vertices % 3];
    }
  }
  return form;
}

}  // namespace lfm::testing
