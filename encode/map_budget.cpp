// SPDX-License-Identifier: BSD-3-Clause
#include "encode/map_budget.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <utility>

#include "core/error.h"
#include "encode/map_coarsening.h"
#include "encode/model_layout.h"
#include "encode/patch_resolution.h"
#include "encode/separate_layout.h"

namespace lfm {
namespace {

// Of the maps as they will lie in the pages.
int64_t LaidOutBytes(const LightFieldSource& source, std::span<const int> edge_samples,
                     const MapSelection& maps, const EncodeOptions& options) {
  const LightFieldModel whole =
      LayOutModel(source, edge_samples, maps.terms, options.max_texture_size);
  if (!ChoosesDetail(options)) {
    return SeparateSurfaceMaps(whole, options.max_texture_size).MapsBytes();
  }
  return LayOutCoarsened(whole, maps, options.max_texture_size).MapsBytes();
}

int64_t Entries(const MapCosts& costs) {
  return std::accumulate(costs.entries.begin(), costs.entries.end(), int64_t{0});
}

double AllowedError(const MapCosts& costs, double target_db) {
  return static_cast<double>(Entries(costs)) * std::pow(10.0, -target_db / 10);
}

double Reached(const MapCosts& costs, double squared_error) {
  return ModelError{squared_error, Entries(costs)}.psnr_db();
}

}  // namespace

void RequireRoomForMeanView(const LightFieldSource& source, std::span<const int> edge_samples,
                            const EncodeOptions& options) {
  if (!(options.target_mb > 0)) return;
  MapSelection none{std::vector<int>(source.mesh.vertices.size(), 0), {}, {}};
  for (const int n : edge_samples) {
    none.levels.push_back({static_cast<uint8_t>(EdgeSampleLevels(n).size() - 1)});
  }
  none.view_levels.resize(none.terms.size());
  const double least = static_cast<double>(LaidOutBytes(source, edge_samples, none, options));
  if (least <= options.target_mb * 1e6) return;
  char text[160];
  std::snprintf(text, sizeof text,
                "--target-mb %g: the mean view alone takes %.3f MB; raise it, or resample a "
                "coarser mesh",
                options.target_mb, least * 1e-6);
  throw Error(text);
}

MapSelection ChooseMaps(const LightFieldSource& source, std::span<const int> edge_samples,
                        const MapCosts& costs, const EncodeOptions& options, Progress& progress) {
  progress.Start("choosing maps", 1);
  if (options.tolerance > 0) return MapsForTolerance(costs, options.tolerance / 255);
  if (options.target_mb > 0) {
    return MapsForBytes(costs, static_cast<int64_t>(options.target_mb * 1e6),
                        [&](const MapSelection& maps) {
                          progress.Advance(0);  // may be interrupted
                          return LaidOutBytes(source, edge_samples, maps, options);
                        });
  }
  if (options.terms != EncodeOptions::kAsNeeded || options.factorization == Factorization::kNmf) {
    return AllMaps(costs);
  }
  if (!(options.target_db > 0)) return MapsForGain(costs, options.term_gain / 255);
  const double allowed = AllowedError(costs, options.target_db);
  MapSelection maps = MapsForError(costs, allowed);
  if (costs.SquaredError(maps) > allowed) {
    char text[160];
    std::snprintf(text, sizeof text,
                  "%d terms reach %.1f dB of the %g dB asked for; raise --max-terms",
                  options.max_terms, Reached(costs, costs.SquaredError(maps)), options.target_db);
    progress.Note(text);
  }
  return maps;
}

Coarsened CoarsenToTarget(
    const LightFieldSource& source, const MapCosts& costs, const EncodeOptions& options,
    const MapSelection& first,
    const std::function<LightFieldModel(const std::vector<int>& terms)>& whole,
    Progress& progress) {
  constexpr int kTrials = 4;
  constexpr double kNear = 0.995;  // of the error allowed: 0.02 dB
  const bool has_target = options.target_db > 0;
  progress.Start("coarsening maps", has_target ? kTrials : 1);
  const auto coarsen = [&](const MapSelection& maps) {
    Coarsened coarse{maps,
                     CoarsenMaps(source, whole(maps.terms), maps, options.guessed_weight,
                                 options.max_texture_size),
                     {}};
    coarse.errors = CompareByTerms(source, coarse.model);
    progress.Advance();
    return coarse;
  };
  Coarsened best = coarsen(first);
  const double allowed = has_target ? AllowedError(costs, options.target_db) : HUGE_VAL;
  if (!has_target || costs.SquaredError(first) > allowed) return best;
  double estimate = allowed, measured = best.errors.back().squared_error;
  for (int trial = 1; trial < kTrials; ++trial) {
    if (measured <= allowed && measured >= kNear * allowed) break;
    estimate *= allowed / std::max(measured, 0.01 * allowed);
    Coarsened next = coarsen(MapsForError(costs, estimate));
    measured = next.errors.back().squared_error;
    const double so_far = best.errors.back().squared_error;
    const bool smaller = next.model.MapsBytes() < best.model.MapsBytes();
    if (so_far > allowed ? measured < so_far : measured <= allowed && smaller) {
      best = std::move(next);
    }
  }
  if (best.errors.back().squared_error > allowed) {
    char text[160];
    std::snprintf(text, sizeof text,
                  "coarser maps reach %.2f dB of the %g dB asked for; take --patch-detail full or "
                  "--view-detail full",
                  Reached(costs, best.errors.back().squared_error), options.target_db);
    progress.Note(text);
  }
  return best;
}

}  // namespace lfm
