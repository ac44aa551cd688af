// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sample_data/bsdf.h"

namespace lfm {

/// The kGlass cases of sample_data/bsdf.h.
bool GlassIsClear(const Material& material);
BsdfValue EvaluateGlass(const Material& material, const Eigen::Vector3f& o,
                        const Eigen::Vector3f& i);
BsdfSample SampleGlass(const Material& material, const Eigen::Vector3f& o, float u_lobe, float u1,
                       float u2);

}  // namespace lfm
