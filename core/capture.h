// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/camera.h"
#include "core/image.h"
#include "core/photo_split.h"
#include "core/pose.h"
#include "core/reflectance_field.h"

namespace lfm {

struct Photo {
  std::string id;      ///< unique among photos, scans and placements; becomes a file name
  std::string file;    ///< relative to the capture folder
  std::string camera;  ///< key of Capture::cameras
  PhotoSplit split = PhotoSplit::kTrain;
  std::optional<Pose> camera_from_world;  ///< given when the capture brings its own poses
  std::string mask;                       ///< relative file, or empty
};

/// One camera of a capture. Intrinsics are given only when the capture brings its own.
struct CaptureCamera {
  int width = 0, height = 0;
  std::optional<Camera> intrinsics;
  /// What 16-bit files of this camera hold (they cannot say so themselves); 8-bit files are sRGB.
  std::optional<ColorEncoding> encoding = std::nullopt;
};

/// One placement of the platform in front of the scanner, with its pattern pictures.
struct ScanSet {
  std::string id;
  std::vector<std::string> frames;        ///< relative files, in the order of the sequence's roles
  std::optional<Pose> camera_from_world;  ///< given when known (ground truth)
};

/// The structured-light rig: one camera and one projector fixed to each other.
struct Scanner {
  std::string camera;                             ///< key of Capture::cameras
  int projector_width = 0, projector_height = 0;  ///< pixels
  std::optional<Camera> projector;                ///< given when known
  std::optional<Pose> projector_from_camera;      ///< given when known
  /// What each frame shows, as names defined in scan/patterns.h ("white", "black",
  /// "column-gray-3", "column-gray-3-inverse", "column-phase-0", "row-gray-3", ...).
  std::vector<std::string> scan_roles, placement_roles;
  std::vector<ScanSet> scans;       ///< the object on the platform, turned between scans
  std::vector<ScanSet> placements;  ///< the empty platform, tilted and raised: calibrate the rig
};

/// What a capture folder holds: the manifest `capture.json` (schema in docs/formats.md).
/// Every path is relative and stays inside the capture folder.
struct Capture {
  std::filesystem::path folder;
  std::string name;
  std::string board;  ///< relative file that describes the platform; empty when poses are given
  std::map<std::string, CaptureCamera> cameras;
  std::vector<Photo> photos;
  std::optional<Scanner> scanner;
  std::optional<ReflectanceField> reflectance_field;
  std::optional<TransportField> transport;
  std::string mesh;  ///< a mesh that the capture brings along, relative; else empty

  /// True when every camera's intrinsics, every photo's pose and a mesh are given: the
  /// pipeline starts at resampling.
  bool BringsGeometry() const;
};

/// Reads and validates `folder/capture.json`. Missing keys, unknown keys, wrong types, repeated
/// ids, ids that are no plain file names, unknown cameras, frame counts that differ from the roles,
/// light directions that are not unit vectors, intensities that are not positive, a reflectance
/// field without pictures or with one twice, and paths that leave the folder (absolute, "..", or
/// through a symbolic link) are Errors that name the place. Listed picture files need not exist
/// yet: stages report those one by one.
Capture LoadCapture(const std::filesystem::path& folder);
/// Writes `folder/capture.json` atomically; the inverse of LoadCapture.
void SaveCapture(const Capture& capture);

/// Loads one picture that a manifest names; tests hand in pictures from memory instead.
using ImageLoader = std::function<Image(const std::string& file)>;
ImageLoader MakeImageLoader(const Capture& capture);

/// Why `file` may not be named by a capture in `folder` (absolute, "..", a symbolic link that leads
/// out); empty when it may.
std::string CapturePathProblem(const std::filesystem::path& folder, const std::string& file);

/// Why `id` may not name a photograph; empty when it may. Ids become file names: letters, digits,
/// '.', '_' and '-', 64 at most, no '.' in front.
std::string PictureIdProblem(const std::string& id);

}  // namespace lfm
