// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/camera.h"
#include "core/capture.h"
#include "core/options.h"
#include "core/pose.h"
#include "core/progress.h"
#include "fields/field.h"

namespace lfm {

/// Which part of a reflectance field's pictures is read, and how fine.
struct FieldReadOptions {
  int reduce = 1;
  int crop_left = 0, crop_top = 0;
  int crop_width = 0, crop_height = 0;  ///< 0: to the picture's border
  void Declare(OptionVisitor& v) {
    v.Integer({"field-reduce", "Average blocks of so many pixels a side into one.", "px", 1, 4096},
              reduce);
    v.Integer({"crop-left", "First column of the pictures that is read.", "px", 0, 65535},
              crop_left);
    v.Integer({"crop-top", "First row of the pictures that is read.", "px", 0, 65535}, crop_top);
    v.Integer({"crop-width", "Columns that are read; 0: all there are.", "px", 0, 65536},
              crop_width);
    v.Integer({"crop-height", "Rows that are read; 0: all there are.", "px", 0, 65536},
              crop_height);
  }
};

/// A reflectance field (Yamada 2009, Section 2): the matrix R of the training pictures, and that of
/// the pictures that were held out for scoring, over the same points.
struct ReflectanceFieldData {
  Field train;     ///< at least one column
  Field held_out;  ///< its `functions` have no rows when nothing is held out
  /// Of each column: the picture's file, relative to the capture.
  std::vector<std::string> train_files, held_out_files;
  std::string camera;                     ///< key of Capture::cameras
  std::optional<Camera> intrinsics;       ///< of the pictures as read: cropped and reduced
  std::optional<Pose> camera_from_world;  ///< when known
};

/// Reads the pictures of `capture.reflectance_field`, which must be there: column j of `train` is
/// the j-th training picture, linear radiance under a light of unit irradiance (divided by the
/// light's `intensity` where one is stated; a gray picture by the Rec. 709 luminance of it), point
/// = y * width + x. Gray or RGB, all alike; alpha is left out.
///
/// A crop is taken first, then blocks of `reduce` x `reduce` pixels are averaged; what is left over
/// at the right and lower border is left out. The mask: a pixel counts at half of white and above,
/// a block when one of its pixels counts; only those are averaged. Rows of points that do not count
/// are zero.
///
/// Takes the matrices (4 bytes a value) and 16 pictures; parallel; the result does not depend on
/// the number of threads.
///
/// Extremes: one light, one pixel, a black field and lights below the horizon of the view are read
/// as they are. Notes say how many negative values were set to zero, which directions come twice,
/// how many lights lie below the horizon (z < 0), and that nothing but black was seen. Throws
/// Error, naming the file and what to do, when there is no training picture, a picture is missing,
/// of another size than its camera's or of other channels than the first, a pixel that counts is
/// not finite, a direction is no unit vector, an intensity is not positive and finite, the mask is
/// of another size or nothing counts, the crop leaves no pixel, or the machine has not the memory.
ReflectanceFieldData ReadReflectanceField(const Capture& capture, const FieldReadOptions& options,
                                          Progress& progress);
/// The same with pictures from elsewhere.
ReflectanceFieldData ReadReflectanceField(const Capture& capture, const ImageLoader& load,
                                          const FieldReadOptions& options, Progress& progress);

}  // namespace lfm
