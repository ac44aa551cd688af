// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "calib/calib.h"
#include "core/point_cloud.h"
#include "core/triangle_mesh.h"

namespace lfm::test {

/// Icosahedron, each triangle split into four `splits` times, corners on the sphere.
TriangleMesh MakeSphere(double radius, int splits,
                        const Eigen::Vector3d& center = Eigen::Vector3d::Zero());
/// A torus about the z axis, tube of radius `tube` about a circle of radius `ring` at `height`.
TriangleMesh MakeTorus(double ring, double tube, double height, int around, int across);
/// An axis-aligned box from `low` to `high`, `cells` squares of two triangles along each edge.
TriangleMesh MakeBox(const Eigen::Vector3d& low, const Eigen::Vector3d& high, int cells);
/// A square in the plane z = `height`, side `side`, centred, facing up, `cells` a side.
TriangleMesh MakeSquare(double side, double height, int cells);

struct CloudNoise {
  double along_normal_mm = 0.04;
  double hidden_below_normal_z = -0.8;  ///< what faces down more than this is not measured
  double hidden_below_mm = 0.6;         ///< nor what is lower than this
  unsigned seed = 1;
};
/// Points on a mesh as a scanner measures them.
PointCloud MeasureCloud(const TriangleMesh& mesh, int count, const CloudNoise& noise = {});
/// Points of the platform about the object, and of the air.
void AddPlatform(PointCloud& cloud, int count, double half_side_mm, double free_radius_mm,
                 double noise_mm, unsigned seed);
void AddOutliers(PointCloud& cloud, int count, double half_side_mm, double height_mm,
                 unsigned seed);
void Append(PointCloud& cloud, const PointCloud& other);
/// `count` points spread evenly, with noise, over a ball with bumps, 40 mm in radius, that stands
/// on the platform.
PointCloud MakeBumpyBall(int64_t count);

/// `count` photographs round the object from `distance_mm`, aimed at `height_mm` over the platform;
/// 960 x 720, focal length 1700 px.
CalibResult MakeCalib(int count, double distance_mm, double height_mm);

/// Smallest angles of all triangles, degrees, ascending.
std::vector<double> SmallestAngles(const TriangleMesh& mesh);
double TotalArea(const TriangleMesh& mesh);
bool IsClosedManifold(const TriangleMesh& mesh);
/// The message of the lfm::Error that `action` throws; empty when it throws none.
std::string ErrorOf(const std::function<void()>& action);

}  // namespace lfm::test
