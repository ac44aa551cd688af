// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "core/options.h"
#include "core/progress.h"
#include "viewer/gl_renderer.h"
#include "viewer/view_options.h"

namespace lfm {

struct ViewerOptions {
  bool wireframe = false;
  ViewCoordinates view_coordinates = ViewCoordinates::kPerPixel;
  BlockUse block_use = BlockUse::kAutomatic;
  int multisample = 4;
  std::string work;
  std::string capture;
  std::string screenshot;
  int frames = 3;
  bool with_panel = false;
  std::string script;
  double ui_scale = 0;
  void Declare(OptionVisitor& v) {
    v.Flag({"wireframe", "Draw the triangles' edges."}, wireframe);
    DeclareViewCoordinates(v, view_coordinates);
    v.Enumeration({"blocks",
                   "Of models in BC1 and BC4: give their blocks to the graphics card as they are, "
                   "or decoded, in eight times the memory, which drivers in software draw faster "
                   "(automatic: on those)."},
                  {"automatic", "as-they-are", "decoded"}, block_use);
    v.Integer({"multisample", "Samples a pixel: smoother edges against time.", "", 1, 16},
              multisample);
    v.Text({"work",
            "The model's working folder: shows the photographs' cameras, and how many photographs "
            "saw each vertex."},
           work);
    v.Text({"capture",
            "With --work: the capture, whose photographs are shown beside the model, with their "
            "difference."},
           capture);
    v.Text({"screenshot", "Save a picture (.png) of the first view here and leave."}, screenshot);
    v.Integer({"frames", "With --screenshot: draw this many frames first.", "", 1, 100000}, frames);
    v.Flag({"with-panel", "With --screenshot: the picture shows the panel, too."}, with_panel);
    v.Text({"script",
            "Play this script (docs/formats.md) as if somebody sat there, in a hidden window, and "
            "leave."},
           script);
    v.Number({"ui-scale",
              "Letters and buttons this many times as large; 0: as the screen asks for.", "", 0, 8},
             ui_scale);
  }
};

/// Opens a window on a model or scene file and returns when the user closes it, or, with a
/// screenshot file or a script, when that is done (the window stays hidden then). What cannot be
/// read is said in the window; with a screenshot or script it is an Error. Throws Error when
/// `model_or_scene` does not exist, when a scene file, the script, or the photographs' folders are
/// wrong, when there is no display or no OpenGL 3.3, or a picture cannot be written; Interrupted on
/// Ctrl-C.
void RunViewer(const std::filesystem::path& model_or_scene, const ViewOptions& view,
               const ViewerOptions& options, Progress& progress);

}  // namespace lfm
