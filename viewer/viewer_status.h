// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "viewer/overlay_colors.h"

namespace lfm {

/// What the viewer has to say about itself: the panel shows it, nobody sets it there.
struct ViewerStatus {
  std::vector<std::string> models;  ///< names
  size_t triangles = 0;             ///< of all models
  double loading_share = 1;         ///< 1: nothing is being read
  std::string loading_what;
  std::string error;  ///< why a model is not shown; stays until another is read

  std::vector<std::string> photographs;  ///< ids; empty without any
  bool photographs_have_pictures = false;
  std::optional<double> photograph_psnr_db;  ///< of what is compared now
  bool photograph_held_out = false;
  std::vector<LegendEntry> legend;
  int passes = 1;
  double film_share = 1;              ///< 1: none is being recorded
  std::vector<float> frame_times_ms;  ///< the last ones, oldest first
};

}  // namespace lfm
