// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "encode/model.h"

namespace lfm::testing {

/// Jumps from one triangle to the next along all edges, in 8-bit levels: the largest of a channel,
/// and RMS over channels and points.
struct EdgeJumps {
  double largest = 0, rms = 0;
};
EdgeJumps JumpsAcrossEdges(const LightFieldModel& model, int terms = 16);

/// The largest jump from one triangle to the next along all edges, in 8-bit levels, with at most
/// `terms` terms, each edge seen from a direction in front of it (the same in every run).
double LargestJumpAcrossEdges(const LightFieldModel& model, int terms = 16);

}  // namespace lfm::testing
