// SPDX-License-Identifier: BSD-3-Clause
#include "encode/map_groups.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "core/parallel.h"
#include "encode/model_layout.h"
#include "encode/quantization.h"

namespace lfm {
namespace {

// Triangles by patch size, of those that `wanted` names.
std::map<int, std::vector<int>> BySize(const LightFieldModel& model,
                                       const std::function<bool(int triangle)>& wanted) {
  std::map<int, std::vector<int>> sizes;
  for (int t = 0; t < static_cast<int>(model.placements.size()); ++t) {
    if (wanted(t)) sizes[model.placements[t].edge_samples].push_back(t);
  }
  return sizes;
}

// Half of the rectangle that two patches share, RGB.
int64_t PatchBytes(int n) { return int64_t{3} * (n + 2) * (n + 1) / 2; }

// The distortion of a group with `codes` codes, between measured points: log-log, and linear down
// to zero.
double DistortionOf(const std::vector<RatePoint>& rates, int codes) {
  if (rates.empty() || codes >= rates.back().codes) return 0;
  size_t next = 1;
  while (next + 1 < rates.size() && rates[next].codes < codes) ++next;
  if (rates.size() == 1) return rates.front().distortion;
  const RatePoint& a = rates[next - 1];
  const RatePoint& b = rates[next];
  if (codes <= a.codes) return a.distortion;
  if (!(b.distortion > 0)) {
    return a.distortion * (b.codes - codes) / static_cast<double>(b.codes - a.codes);
  }
  const double along = std::log(static_cast<double>(codes) / a.codes) /
                       std::log(static_cast<double>(b.codes) / a.codes);
  return a.distortion * std::pow(b.distortion / a.distortion, along);
}

struct Allocation {
  std::vector<int> codes;
  int64_t bytes = 0;
  double distortion = 0;
};

using Rates = std::vector<std::vector<RatePoint>>;

// The least of distortion + price * bytes, for each group.
Allocation Allocate(std::span<const MapGroup> groups, const Rates& rates, double price) {
  constexpr double kStep = 1.08;
  Allocation allocation;
  for (size_t g = 0; g < groups.size(); ++g) {
    const int most = rates[g].empty() ? 1 : std::max(1, rates[g].back().codes);
    int best = 1;
    double least = HUGE_VAL;
    for (int codes = 1; codes <= most;) {
      const double cost =
          DistortionOf(rates[g], codes) + price * static_cast<double>(codes * groups[g].code_bytes);
      if (cost < least) {
        least = cost;
        best = codes;
      }
      if (codes == most) break;
      codes = std::min(most, std::max(codes + 1, static_cast<int>(codes * kStep)));
    }
    allocation.codes.push_back(best);
    allocation.bytes += best * groups[g].code_bytes;
    allocation.distortion += DistortionOf(rates[g], best);
  }
  return allocation;
}

// The lowest price (`rises`: the highest) at which an allocation fits.
std::vector<int> AllocateToFit(std::span<const MapGroup> groups,
                               const std::function<bool(const Allocation&)>& fits, bool dear_fits) {
  Rates rates(groups.size());
  for (size_t g = 0; g < groups.size(); ++g) rates[g] = MeasureRates(groups[g].vectors);
  double cheap = -40, dear = 40;  // log10 of the price
  Allocation best = Allocate(groups, rates, std::pow(10.0, dear_fits ? dear : cheap));
  constexpr int kRounds = 60;
  for (int i = 0; i < kRounds; ++i) {
    const double middle = (cheap + dear) / 2;
    Allocation allocation = Allocate(groups, rates, std::pow(10.0, middle));
    const bool fit = fits(allocation);
    (fit == dear_fits ? dear : cheap) = middle;
    if (fit) best = std::move(allocation);
  }
  return best.codes;
}

}  // namespace

MapScales MeasureMapScales(const LightFieldModel& model) {
  const size_t vertices = model.vertex_terms.size();
  MapScales scales{std::vector<float>(model.terms * vertices, 0.f),
                   std::vector<float>(model.terms * vertices, 0.f)};
  const VertexRings rings = ComputeVertexRings(model.mesh);
  ParallelFor(0, static_cast<int64_t>(vertices), [&](int64_t v) {
    const auto ring = std::span<const int>(rings.triangles)
                          .subspan(rings.offsets[v], rings.offsets[v + 1] - rings.offsets[v]);
    for (int k = 0; k < model.vertex_terms[v]; ++k) {
      const TermMaps maps = ReadVertexTerm(model, ring, static_cast<int>(v), k);
      double surface = 0, view = 0;
      for (const uint8_t code : maps.surface_codes) {
        const double value = DecodeValue(maps.surface_range, code);
        surface += value * value;
      }
      for (const uint8_t code : maps.view_codes) {
        const double value = DecodeValue(maps.view_range, code);
        view += value * value;
      }
      const double samples = static_cast<double>(std::max<size_t>(1, maps.surface_codes.size()));
      scales.surface_rms[k * vertices + v] = static_cast<float>(std::sqrt(surface / samples));
      scales.view_energy[k * vertices + v] = static_cast<float>(view);
    }
  });
  return scales;
}

std::vector<MapGroup> MeanGroups(const LightFieldModel& model) {
  std::vector<MapGroup> groups;
  for (auto& [n, triangles] : BySize(model, [](int) { return true; })) {
    MapGroup group{n, std::move(triangles), {3 * PatchSampleCount(n), 1, {}, {}}, PatchBytes(n)};
    for (const int t : group.owners) {
      for (const uint8_t code : ReadMean(model, t)) {
        group.vectors.values.push_back(static_cast<float>(code) / 255);
      }
      group.vectors.weights.push_back(static_cast<float>(model.grid * model.grid));
    }
    groups.push_back(std::move(group));
  }
  return groups;
}

std::vector<MapGroup> SurfaceGroups(const LightFieldModel& model, const MapScales& scales,
                                    int term) {
  const size_t vertices = model.vertex_terms.size();
  std::vector<MapGroup> groups;
  for (auto& [n, triangles] : BySize(model, [&](int t) { return model.TriangleTerms(t) > term; })) {
    const int samples = PatchSampleCount(n);
    MapGroup group{n, std::move(triangles), {3 * samples, 3, {}, {}}, PatchBytes(n)};
    group.vectors.values.reserve(size_t{3} * samples * group.owners.size());
    for (const int t : group.owners) {
      const PatchPlacement& placement = model.SurfacePlacement(term, t);
      for (int c = 0; c < 3; ++c) {
        const int vertex = model.mesh.triangles[t][c];
        const float rms = scales.surface_rms[term * vertices + vertex];
        const float weight = rms * rms * scales.view_energy[term * vertices + vertex];
        group.vectors.weights.push_back(weight);
        for (const uint8_t code :
             ReadPatch(model.surface_pages[term][placement.page], placement, c, 1)) {
          const float value = DecodeValue(model.surface_ranges[term * vertices + vertex], code);
          group.vectors.values.push_back(rms > 0 ? value / rms : 0.f);
        }
      }
    }
    groups.push_back(std::move(group));
  }
  return groups;
}

MapGroup ViewGroup(const LightFieldModel& model, std::span<const FittedViews> views, int term) {
  const int length = 3 * model.grid * model.grid;
  MapGroup group{0, {}, {length, 1, {}, {}}, length};
  for (int v = 0; v < static_cast<int>(views.size()); ++v) {
    if (model.vertex_terms[v] <= term) continue;
    group.owners.push_back(v);
    const std::vector<float>& view = views[v].views[term];
    double sum = 0, squares = 0;
    for (const float value : view) sum += value;
    const double mean = sum / length;
    for (const float value : view) squares += (value - mean) * (value - mean);
    const double rms = std::sqrt(squares / length);
    group.vectors.weights.push_back(static_cast<float>(views[v].gram(term, term) * rms * rms));
    for (const float value : view) {
      group.vectors.values.push_back(rms > 0 ? static_cast<float>((value - mean) / rms) : 0.f);
    }
  }
  return group;
}

std::vector<int> CodesForBytes(std::span<const MapGroup> groups, int64_t max_bytes) {
  return AllocateToFit(
      groups, [&](const Allocation& a) { return a.bytes <= max_bytes; }, true);
}

std::vector<int> CodesForDistortion(std::span<const MapGroup> groups, double max_distortion) {
  return AllocateToFit(
      groups, [&](const Allocation& a) { return a.distortion <= max_distortion; }, false);
}

}  // namespace lfm
