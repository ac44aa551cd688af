// SPDX-License-Identifier: BSD-3-Clause
// What --effort stands for.
#include "pipeline/pipeline.h"

namespace lfm {

PipelineOptions PresetOptions(Effort effort) {
  PipelineOptions options;
  options.effort = effort;
  switch (effort) {
    case Effort::kFast:
      options.mesh.poisson_depth = 7;
      options.mesh.tolerance_px = 1.0;
      options.resample.view_grid = 12;
      options.encode.term_gain = 1.5;
      options.encode.max_terms = 5;
      break;
    case Effort::kBalanced:
      break;
    case Effort::kBest:
      options.mesh.tolerance_px = 0.25;
      options.resample.sample_density = 1.5;
      options.encode.term_gain = 0.3;
      break;
  }
  return options;
}

}  // namespace lfm
