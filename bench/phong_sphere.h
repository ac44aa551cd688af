// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

namespace lfm::bench {

/// Figure 8 of Mahajan 2007: clusters of a Phong sphere seen from far away, its rows in closed form
/// (cos^exponent of the angle between mirrored eye and light, over a cube map). Writes the clusters
/// in colours and prints how much longer they are along the rim than across it, in the middle and
/// near the rim.
void DrawPhongSphere(double exponent, int clusters, const std::filesystem::path& png);

}  // namespace lfm::bench
