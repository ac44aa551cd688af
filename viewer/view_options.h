// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>

#include "core/options.h"
#include "encode/model_evaluation.h"
#include "viewer/orbit_camera.h"
#include "viewer/tone.h"

namespace lfm {

/// From where, how large and with what a model is shown: what lfm-render and lfm-viewer share.
struct ViewOptions {
  double azimuth = 300;
  double elevation = 25;
  double distance = 0;
  double fov = 30;
  std::string size = "960x720";
  std::string background = "181a1f";
  int terms = 16;
  bool mean_only = false;
  int term_alone = 0;
  double exposure = 0;
  ToneCurve tone = ToneCurve::kClip;
  void Declare(OptionVisitor& v) {
    v.Number({"azimuth", "Where the eye stands, from the x axis towards y.", "deg", -3600, 3600},
             azimuth);
    v.Number({"elevation", "How high the eye stands above the platform.", "deg", -89, 89},
             elevation);
    v.Number(
        {"distance", "From the object's centre to the eye; 0 fits the object in.", "mm", 0, 1e9},
        distance);
    v.Number({"fov", "Vertical field of view.", "deg", 1, 150}, fov);
    v.Text({"size", "Width and height of the picture, as 960x720.", "pixels"}, size);
    v.Text({"background", "Colour behind the object, rrggbb in hexadecimal."}, background);
    v.Integer({"terms", "Use at most this many terms a vertex; 0 is the mean view.", "", 0, 1024},
              terms);
    v.Flag({"mean-only", "Show the mean view alone, as a plain textured mesh would look."},
           mean_only);
    v.Integer({"term-alone",
               "Show this term by itself, over gray (over black where terms hold the mean view); 0 "
               "shows none so.",
               "", 0, 1024},
              term_alone);
    v.Number({"exposure", "Brighter by this many stops (doublings of light).", "stops", -10, 10},
             exposure);
    v.Enumeration({"tone",
                   "Light beyond white: cut off (clip), or everything above four fifths rolled off "
                   "towards it (soft)."},
                  {"clip", "soft"}, tone);
  }
};

struct PictureSize {
  int width = 0, height = 0;  ///< pixels
};
/// "960x720". Throws Error unless both are whole numbers in [1, 16384].
PictureSize ParsePictureSize(const std::string& text);
/// "rrggbb" or "#rrggbb" as sRGB-coded [0, 1]. Throws Error for anything else.
Eigen::Vector3f ParseColor(const std::string& text);

Tone MakeTone(const ViewOptions& options);
EvaluationOptions MakeEvaluationOptions(const ViewOptions& options);
/// The camera that looks at `mesh` as the options say; `distance` is honoured as given.
OrbitCamera MakeOrbitCamera(const TriangleMesh& mesh, const ViewOptions& options);

}  // namespace lfm
