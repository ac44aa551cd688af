// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "fields/light_cells.h"
#include "fields/light_probe.h"
#include "fields/light_triangulation.h"
#include "fields/light_vector.h"

namespace lfm {

/// The light vector of a probe, RGB, in the unit of the field's columns. kLights: the irradiance of
/// each cell's light on a surface that faces it, the integral of radiance over the cell (W/m^2 for
/// W/m^2 sr). kCubeTexels: the mean radiance in each texel.
///
/// `turn_deg` turns the surroundings about +z, counter-clockwise seen from above: light of azimuth
/// a comes from a + turn. Exact for a probe that is constant over each pixel and cells that are
/// over 1024 x 512 places, whatever the angle: the total stays the same up to what the cells leave
/// out.
LightVector SampleProbe(const LightCells& cells, const LightProbe& probe, double turn_deg = 0);

/// The same for any rotation: light from d in the probe comes from `world_from_probe` d. Each of
/// 512 x 256 pixels counts for the cell that its middle falls into, so all light is kept, and
/// cells are right to about a pixel's width. Parallel; does not depend on the number of threads.
LightVector SampleProbeTurned(const LightCells& cells, const LightProbe& probe,
                              const Eigen::Matrix3d& world_from_probe);

/// Light of parallel rays from one direction (towards the light, any length but 0), of irradiance 1
/// on a surface that faces it: shared among the lights round it (InterpolateLights), or, for
/// kCubeTexels, brought to radiance by each texel's solid angle. One channel; what was captured
/// under a light comes back as it was when that light is asked for. Throws Error for a direction
/// without length or not finite.
LightVector SampleDirection(const LightCells& cells, const LightTriangulation& lights,
                            const Eigen::Vector3d& to_light);

/// A round area light of irradiance 1: the mean of SampleDirection over a cap of `radius_deg`
/// degrees (0 to 180) round `to_light`, at 64 places of equal solid angle.
LightVector SampleCap(const LightCells& cells, const LightTriangulation& lights,
                      const Eigen::Vector3d& to_light, double radius_deg);

}  // namespace lfm
