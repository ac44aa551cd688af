// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "calib/board.h"
#include "calib/model_trials.h"
#include "calib/platform_shape.h"
#include "core/camera.h"
#include "core/capture.h"
#include "core/options.h"
#include "core/pose.h"
#include "core/progress.h"

namespace lfm {

/// A corner of the platform that a picture shows.
struct SeenCorner {
  Eigen::Vector3d point_in_world = {0, 0, 0};  ///< where the platform has it (platform_shape), mm
  Eigen::Vector2d pixel = {0, 0};
};

/// One picture whose camera pose is known.
struct PosedImage {
  std::string id;
  std::string camera;      ///< key of CalibResult::cameras
  std::string file;        ///< the picture that was used, relative to the capture folder
  Pose camera_from_world;  ///< world = platform frame
  /// Covariance of (rotation vector applied on the left, translation), rad and mm: what the
  /// corners' noise leaves open, with what is not known of intrinsics and platform. Row-major in
  /// files.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  int tags = 0, corners = 0;       ///< found; corners used in the fit
  double reprojection_rms_px = 0;  ///< sqrt(mean(dx^2 + dy^2)) over inliers
  PhotoSplit split = PhotoSplit::kTrain;
  /// The corners used, of scans and placements: the scanner's rig is adjusted to them together with
  /// what its projector shows. Photographs list none.
  std::vector<SeenCorner> seen;
  /// Of the file when it was calibrated (FileFingerprint); empty when not known.
  std::string fingerprint;
};

struct RejectedImage {
  std::string id, file;
  std::string reason;  ///< one line for people
};

struct CalibResult {
  std::map<std::string, Camera> cameras;
  /// How many of k1, k2, p1, p2, k3, k4, k5, k6 (in this order) each camera needed: 0, 1, 2, 4, 5
  /// or 8, the rest is 0. Cameras whose intrinsics were given are not listed.
  std::map<std::string, int> lens_terms;
  /// What that choice was made by; no trials where there were too few pictures to tell.
  std::map<std::string, std::vector<LensTrial>> lens_trials;
  /// Covariance of the intrinsics that were adjusted: fx, fy, cx, cy, then the lens terms.
  std::map<std::string, Eigen::MatrixXd> intrinsics_covariance;
  std::string platform_model = "as printed";  ///< PlatformModelName
  std::vector<PlatformTrial> platform_trials;
  PlatformShape platform_shape;
  std::vector<PosedImage> photos;  ///< train and test, in manifest order
  std::vector<PosedImage> scans;   ///< platform pose of every scan: camera_from_world of its rig
  std::vector<PosedImage> placements;  ///< the same for the empty, tilted platform
  std::vector<RejectedImage> rejected;
  double reprojection_rms_px = 0;  ///< over inlier corners of the train photographs
  /// Estimated standard deviation of a corner coordinate of mean weight, with what neighbours
  /// share.
  double corner_noise_px = 0;
};

/// What the search for corners starts from (calib/circle_match.h).
enum class BoardSearch {
  kAuto,     ///< tags; circles where fewer than three tags agree
  kTags,     ///< tags alone
  kCircles,  ///< circles; tags where they do not suffice
};

struct CalibOptions {
  double max_reprojection_px = 1.0;
  int min_corners = 12;
  double robust_scale_px = 0.5;
  double print_error_mm = 0.3;
  BoardSearch start = BoardSearch::kAuto;
  void Declare(OptionVisitor& v) {
    v.Number({"max-reprojection-px",
              "Set a photograph aside when its own corners fit worse than "
              "this.",
              "px", 0.01, 100},
             max_reprojection_px);
    v.Integer(
        {"min-corners",
         "Set a photograph aside when fewer corners than this, or than all that the board has, are "
         "found.",
         "", 4, 10000},
        min_corners);
    v.Number({"robust-scale-px", "Corner errors beyond this count less and less (Cauchy loss).",
              "px", 0.01, 100},
             robust_scale_px);
    v.Number({"print-error-mm",
              "How far tags may lie from where the board's file says, a standard deviation; used "
              "where pictures ask for it.",
              "mm", 1e-4, 10},
             print_error_mm);
    v.Enumeration({"start",
                   "What the search for corners starts from: tags; the board's coloured circles "
                   "(tags where they do not suffice); or, auto, tags, and circles where fewer than "
                   "three tags are found."},
                  {"auto", "tags", "circles"}, start);
  }
};

/// Finds the platform in every photograph and every scan's white picture, estimates the intrinsics
/// of each camera from the pictures themselves (train photographs; for the scanner's camera its
/// scans and placements), and the pose of every picture. Test photographs are posed by their own
/// corners after the intrinsics are fixed. Lens terms and departures of the platform from its file
/// enter as corners kept out of the fit ask for them. Throws Error when fewer than three pictures
/// of a camera can be used, when pictures do not tell its focal length or principal point, and for
/// a board whose sizes can only be metres; one failed picture is set aside with the reason.
CalibResult Calibrate(const Capture& capture, const Board& board, const ImageLoader& load_image,
                      const CalibOptions& options, Progress& progress);

}  // namespace lfm
