// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

namespace lfm {

/// A pinhole camera (or projector) with Brown's lens distortion, radially rational where k4 to k6
/// are not 0 (OpenCV's rational model).
///
/// With (x, y) = (X/Z, Y/Z) and r2 = x^2 + y^2:
///   s = (1 + k1 r2 + k2 r2^2 + k3 r2^3) / (1 + k4 r2 + k5 r2^2 + k6 r2^3)
///   x' = x s + 2 p1 x y + p2 (r2 + 2 x^2)
///   y' = y s + p1 (r2 + 2 y^2) + 2 p2 x y
///   u = fx x' + cx,  v = fy y' + cy
/// Axes are OpenCV's (x right, y down, z forward). The centre of the top-left pixel is (0, 0).
struct Camera {
  int width = 0;                  ///< pixels
  int height = 0;                 ///< pixels
  double fx = 0, fy = 0;          ///< focal lengths, pixels
  double cx = 0, cy = 0;          ///< principal point, pixels
  double k1 = 0, k2 = 0, k3 = 0;  ///< radial distortion
  double p1 = 0, p2 = 0;          ///< tangential distortion
  double k4 = 0, k5 = 0, k6 = 0;  ///< radial distortion, below the line

  bool HasDistortion() const {
    return k1 != 0 || k2 != 0 || k3 != 0 || p1 != 0 || p2 != 0 || IsRational();
  }
  bool IsRational() const { return k4 != 0 || k5 != 0 || k6 != 0; }
  /// True when `pixel` lies on the sensor: [-0.5, width - 0.5) x [-0.5, height - 0.5).
  bool Contains(const Eigen::Vector2d& pixel) const;
};

/// Pixel of a point given in the camera frame (mm). No answer when the point is not in front of
/// the camera (Z <= 0), is not finite, or lies so far off axis that the radius in the picture is no
/// longer increasing there (the lens model folds back; such a point is not in the picture).
std::optional<Eigen::Vector2d> Project(const Camera& camera,
                                       const Eigen::Vector3d& point_in_camera);

/// Distorts normalised coordinates (x, y) = (X/Z, Y/Z).
Eigen::Vector2d Distort(const Camera& camera, const Eigen::Vector2d& normalized);

/// Unit direction in the camera frame through `pixel`: the inverse of Project.
///
/// Newton's method on the distortion: for a pixel with coordinates up to 65536, Project of the
/// answer returns the pixel within 1e-9 px. No answer where no direction is seen at that pixel (the
/// lens model folds back before it), and for a pixel that is not finite.
std::optional<Eigen::Vector3d> TryUnproject(const Camera& camera, const Eigen::Vector2d& pixel);
/// The same where a direction is needed: throws Error when there is no answer.
Eigen::Vector3d Unproject(const Camera& camera, const Eigen::Vector2d& pixel);

/// A camera whose picture is `factor` times as large, pixel centres kept in place.
Camera ScaleCamera(const Camera& camera, double factor);

/// Throws Error, naming `where`, unless sizes are in [1, 65536], focal lengths are positive, and
/// every number is finite.
void ValidateCamera(const Camera& camera, const char* where);

}  // namespace lfm
