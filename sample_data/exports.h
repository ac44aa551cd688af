// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "core/capture.h"

namespace lfm {

// True cameras and poses of a capture in the forms that other programs read. `capture` names the
// picture files, `truth` has intrinsics, poses and masks of the same photographs (matched by id);
// their folders must be set. All throw Error when a photograph lacks intrinsics or a pose in
// `truth`, and when a file cannot be written.

/// A COLMAP text model: cameras.txt, images.txt (poses world-to-camera, quaternion w x y z,
/// translation in mm) and points3D.txt without points. Names of images are relative to the
/// capture's folder. COLMAP puts (0, 0) at the corner of the first pixel: cx, cy gain 0.5. The
/// model is OPENCV (k1 k2 p1 p2), or FULL_OPENCV where k3 is not 0. Beside it, train.txt and
/// test.txt list the names of either split.
/// Throws Error, too, for a file name with white space, which the format cannot hold.
void WriteColmapModel(const Capture& capture, const Capture& truth,
                      const std::filesystem::path& folder);

/// transforms.json as nerfstudio and instant-ngp read it: camera-to-world matrices, mm, with the
/// camera's axes turned to OpenGL's (x right, y up, z backwards); cx, cy from the corner of the
/// first pixel; intrinsics and k1 k2 k3 p1 p2 a frame; file_path and mask_path relative to the
/// file; train_filenames and test_filenames (nerfstudio); scale and offset that put 300 mm into
/// instant-ngp's unit cube, centred on 60 mm above the platform. instant-ngp ignores k3.
/// applied_transform and applied_scale say that poses are still in the world frame and in mm.
void WriteNerfTransforms(const Capture& capture, const Capture& truth,
                         const std::filesystem::path& file);

/// Masks under the names that tools look for: FOLDER/colmap/NAME.png for image NAME (COLMAP's
/// mask_path; 0 is left out), FOLDER/instant-ngp/dynamic_mask_STEM.png (to lie beside the picture;
/// what is not 0 is left out, so these are inverted). Photographs without a mask are passed over.
void WriteToolMasks(const Capture& capture, const Capture& truth,
                    const std::filesystem::path& folder);

/// One line of an .lp file.
struct LightPosition {
  std::string file;                      ///< the picture, as the file names it
  Eigen::Vector3d to_light = {0, 0, 1};  ///< unit
};

/// A light position file as RTI builders read it: the number of pictures, then "file x y z" a line.
/// x, y, z is the unit direction to the light in the frame of `to_light`. Throws Error for an empty
/// list, a name that is empty or holds white space, and a direction that is not a unit vector.
void WriteLightPositions(const std::vector<LightPosition>& lights,
                         const std::filesystem::path& file);

/// The lights of a reflectance field, file names relative to `folder`. RTI's frame is the
/// picture's: x to the right, y up, z to the viewer; directions are turned into it when the field's
/// pose is known, and stay in the world frame otherwise.
std::vector<LightPosition> FieldLightPositions(const Capture& capture,
                                               const std::filesystem::path& folder);

/// All of the above that `capture` has, in truth.folder / "exports": colmap/, nerf/transforms.json,
/// masks/ and, for a reflectance field, rti/lights.lp with the training pictures.
void WriteExports(const Capture& capture, const Capture& truth);

}  // namespace lfm
