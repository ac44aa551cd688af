// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace lfm {

/// What photographs show of one triangle.
struct TriangleShades {
  std::vector<uint16_t> photos;             ///< ascending
  std::vector<Eigen::Vector3d> radiance;    ///< as `photos`: mean linear RGB, 1 a full sensor
  std::vector<Eigen::Vector2d> directions;  ///< as `photos`: unit direction to the eye, its part
                                            ///< in the triangle's plane
};

/// Exposure and white balance of each photograph, relative to the others.
struct PhotoGains {
  /// By which a photograph's linear RGB is to be divided. The geometric mean over all photographs
  /// that were compared is one a channel, for nothing tells the exposure that they share.
  std::vector<Eigen::Vector3d> gains;
  int triangles = 0;  ///< compared
  /// How far a photograph is from a smooth function of the direction, as a relative error: the
  /// median over triangles that were kept out of the fit of their RMS error, bright and dull alike;
  /// without and with gains.
  double error_without = 0, error_with = 0;

  /// Whether photographs need gains: those found on one half of the triangles take at least a fifth
  /// of the error off the other half. Of photographs with one exposure it stays what it was, for
  /// what is left is noise and gloss.
  bool Needed() const { return error_with < 0.8 * error_without; }
};

/// Estimates gains from triangles that several photographs see:
///
///   log radiance(t, p) = s_t(direction) + log gain_p + noise,
///
/// with s_t a polynomial of second degree of its own for each triangle (diffuse colour, slopes of
/// gloss), drawn towards a constant. Least squares over all triangles and photographs, each channel
/// by itself, with weights of Student's t distribution and a scale of its own for each triangle:
/// dull triangles count most, highlights hardly. Dark values count less, by their rounding to 8
/// bits.
///
/// On a glossy object about 3 % of error stays in the gains, common to many triangles (measured on
/// the studio's bust, docs/figures.md); on dull ones far less.
///
/// Photographs that share no triangle with others get one; so do all when there is nothing to
/// compare (fewer than two photographs, no triangle seen by six). Radiances that are not positive
/// count as the darkest. Gains lie in [1/64, 64] before the common factor is taken out. Parallel
/// over channels; the result does not depend on the number of threads.
PhotoGains EstimatePhotoGains(const std::vector<TriangleShades>& shades, size_t photo_count);

/// Standard deviation of the exposures in stops: of log2 of the green gains.
double ExposureSpreadStops(const std::vector<Eigen::Vector3d>& gains);

/// Writes `photo_gains.json` (docs/formats.md). `applied` empty: none were needed.
void SavePhotoGains(const std::vector<std::string>& photo_ids,
                    const std::vector<Eigen::Vector3d>& applied,
                    const std::filesystem::path& folder);

}  // namespace lfm
