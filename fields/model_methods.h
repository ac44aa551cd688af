// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "fields/light_methods.h"
#include "fields/relightable_model.h"

namespace lfm {

/// A model to be relit as methods, one for every number of residuals a row in `residuals`
/// (negative: all): a light from elsewhere is made of the model's directions
/// (InterpolateLights). Names are `name` with the number; bytes those of a file that
/// keeps so many. Throws Error as Relighter does.
std::vector<LightMethod> ModelMethods(const RelightableModel& relightable, const std::string& name,
                                      const std::vector<int>& residuals);

}  // namespace lfm
