// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/options.h"
#include "encode/model.h"
#include "viewer/gl_renderer.h"
#include "viewer/view_options.h"

namespace lfm {

struct ViewerOptions {
  bool wireframe = false;
  ViewCoordinates view_coordinates = ViewCoordinates::kPerPixel;
  BlockUse block_use = BlockUse::kAsTheyAre;
  int multisample = 4;
  std::string screenshot;
  int frames = 3;
  bool with_panel = false;
  void Declare(OptionVisitor& v) {
    v.Flag({"wireframe", "Draw the triangles' edges."}, wireframe);
    DeclareViewCoordinates(v, view_coordinates);
    v.Enumeration({"blocks",
                   "Of models in BC1 and BC4: give their blocks to the graphics card as they are, "
                   "or decoded, which drivers in software draw faster."},
                  {"as-they-are", "decoded"}, block_use);
    v.Integer({"multisample", "Samples a pixel: smoother edges against time.", "", 1, 16},
              multisample);
    v.Text({"screenshot", "Save a picture (.png) of the first view here and leave."}, screenshot);
    v.Integer({"frames", "With --screenshot: draw this many frames first.", "", 1, 100000}, frames);
    v.Flag({"with-panel", "With --screenshot: the picture shows the panel, too."}, with_panel);
  }
};

/// Opens a window on `model` and returns when the user closes it, or, with a screenshot file, when
/// that is written (the window stays hidden then). Throws Error when there is no display or no
/// OpenGL 3.3, or the picture cannot be written; Interrupted on Ctrl-C.
void RunViewer(const LightFieldModel& model, const ViewOptions& view, const ViewerOptions& options);

}  // namespace lfm
