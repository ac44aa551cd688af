// SPDX-License-Identifier: BSD-3-Clause
#include "scan/uncertainty.h"

#include <ceres/jet.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/lens_distortion.h"

namespace lfm {

double ColumnSigmaPx(const RigCalibration& rig, const RigUncertainty& uncertainty,
                     const Eigen::Vector3d& point_in_camera) {
  using Jet = ceres::Jet<double, 14>;
  const Camera& c = rig.projector;
  const Eigen::Vector3d turned = rig.projector_from_camera.rotation * point_in_camera;
  const Eigen::Vector3d& t = rig.projector_from_camera.translation;
  if (!((turned + t).z() > 0)) return 0;
  // To first order a rotation vector w on the left adds w x turned.
  const Jet wx(0, 8), wy(0, 9), wz(0, 10);
  const Jet x = turned.x() + (wy * turned.z() - wz * turned.y()) + Jet(t.x(), 11);
  const Jet y = turned.y() + (wz * turned.x() - wx * turned.z()) + Jet(t.y(), 12);
  const Jet z = turned.z() + (wx * turned.y() - wy * turned.x()) + Jet(t.z(), 13);
  const LensTerms<Jet> lens{Jet(c.k1, 4), Jet(c.k2, 5), Jet(c.k3), Jet(c.p1, 6),
                            Jet(c.p2, 7), Jet(c.k4),    Jet(c.k5), Jet(c.k6)};
  const Jet column = Jet(c.fx, 0) * DistortNormalized<Jet>(lens, x / z, y / z)[0] + Jet(c.cx, 2);
  const double variance = column.v.dot(uncertainty.projector * column.v);
  return std::isfinite(variance) ? std::sqrt(std::max(0.0, variance)) : 0;
}

double PoseVarianceMm2(const Eigen::Matrix<double, 6, 6>& covariance,
                       const Eigen::Vector3d& arm_in_camera,
                       const Eigen::Vector3d& normal_in_camera) {
  Eigen::Matrix<double, 6, 1> a;
  a << arm_in_camera.cross(normal_in_camera), normal_in_camera;
  return std::max(0.0, a.dot(covariance * a));
}

}  // namespace lfm
