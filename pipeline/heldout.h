// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "calib/calib.h"
#include "core/capture.h"
#include "core/image_metrics.h"
#include "core/progress.h"
#include "core/triangle_mesh.h"
#include "viewer/reference_renderer.h"

namespace lfm {

/// How one held-out photograph was shown.
struct PhotoScore {
  std::string id;
  ImageDifference full, mean_only;
};

/// A test photograph that no score counts.
struct MissingPhoto {
  std::string id;
  std::string reason;  ///< one line for people
};

/// Figures over all held-out photographs. PSNR is that of the mean squared error over all their
/// foreground pixels together; SSIM and APE are weighted by foreground pixels. Without any
/// photograph the figures are zero and mean nothing.
struct HeldoutScores {
  std::vector<PhotoScore> photos;
  std::vector<MissingPhoto> missing;
  double psnr_db = 0, psnr_mean_only_db = 0, ssim = 0, ape = 0;
  double psnr_mean_of_photos_db = 0;  ///< the literature's other habit
};

/// A picture for one photograph: its foreground mask (8 bit, one channel), or the reference.
using PictureOf = std::function<Image(const PosedImage&)>;

struct HeldoutPictures {
  std::vector<PictureOf> references;  ///< the photograph, 8-bit RGB; also in other forms
  PictureOf foreground;               ///< the mask (DESIGN 2): never the model's own coverage
};

/// The capture's photographs.
PictureOf PhotographsOf(const Capture& capture);
/// Where the dense surface is seen. Refers to `calib` later on.
PictureOf SilhouettesOf(const TriangleMesh& surface, const CalibResult& calib);

/// Renders every test photograph's camera, lens distortion included, with all terms and with the
/// mean view alone, and compares foreground pixels. A photograph without foreground is skipped and
/// listed as missing; so the scores may be those of no photograph at all.
/// Returns one HeldoutScores a reference. Throws Error, naming the photograph, when pictures cannot
/// be read or compared.
std::vector<HeldoutScores> ScoreModel(const ReferenceRenderer& renderer, const CalibResult& calib,
                                      const HeldoutPictures& pictures, Progress& progress);

/// Scores pictures that anybody made by the same rule: `rendering(photo)` for every test
/// photograph. `mean_only` is left empty.
std::vector<HeldoutScores> ScorePictures(const PictureOf& rendering, const CalibResult& calib,
                                         const HeldoutPictures& pictures, Progress& progress);

/// Adds the test photographs of `capture` that `calib` gave no pose, with the calibration's reason.
void AddUnposedPhotos(const Capture& capture, const CalibResult& calib, HeldoutScores& scores);

/// What ScoreModel renders for one camera, 8-bit RGB: four rays a pixel; a pixel that the model
/// covers in part shows that part's colour, not mixed with any background; one that it does not
/// cover at all is black.
Image RenderPhotoCamera(const ReferenceRenderer& renderer, const CalibResult& calib,
                        const PosedImage& photo, int terms);

/// The `evaluate` figures of docs/formats.md. `heldout_...` figures are there only when a
/// photograph was scored; a `note` says when none or not every one was.
nlohmann::json ScoresToJson(const HeldoutScores& scores);

}  // namespace lfm
