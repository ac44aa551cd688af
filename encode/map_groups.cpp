// SPDX-License-Identifier: BSD-3-Clause
#include "encode/map_groups.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "core/parallel.h"
#include "encode/model_layout.h"
#include "encode/patch_resolution.h"
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

// One form of a group: its rates, and what it costs.
struct Form {
  std::vector<RatePoint> rates;
  int64_t code_bytes = 0;
  double lost = 0;
};
using Forms = std::vector<Form>;  // of one group, by halvings

constexpr int kMostHalvings = 2;

Forms FormsOf(const MapGroup& group) {
  Forms forms = {{MeasureRates(group.vectors), group.code_bytes, group.lost}};
  std::optional<MapGroup> half = HalfResolution(group);
  while (half && static_cast<int>(forms.size()) <= kMostHalvings) {
    forms.push_back({MeasureRates(half->vectors), half->code_bytes, half->lost});
    half = HalfResolution(*half);
  }
  return forms;
}

// The least of distortion + price * bytes, for each group.
GroupAllocation Allocate(const std::vector<Forms>& groups, double price) {
  constexpr double kStep = 1.08;
  GroupAllocation allocation;
  for (const Forms& forms : groups) {
    GroupChoice best;
    double least = HUGE_VAL, distortion = 0;
    for (int form = 0; form < static_cast<int>(forms.size()); ++form) {
      const Form& own = forms[form];
      const int most = own.rates.empty() ? 1 : std::max(1, own.rates.back().codes);
      for (int codes = 1; codes <= most;) {
        const double lost = own.lost + DistortionOf(own.rates, codes);
        const double cost = lost + price * static_cast<double>(codes * own.code_bytes);
        if (cost < least) {
          least = cost;
          best = {form, codes};
          distortion = lost;
        }
        if (codes == most) break;
        codes = std::min(most, std::max(codes + 1, static_cast<int>(codes * kStep)));
      }
    }
    allocation.choices.push_back(best);
    allocation.bytes += best.codes * forms[best.halvings].code_bytes;
    allocation.distortion += distortion;
  }
  return allocation;
}

// The lowest price at which an allocation fits, or the highest.
enum class Fits { kWhenDear, kWhenCheap };
GroupAllocation AllocateToFit(std::span<const MapGroup> groups,
                              const std::function<bool(const GroupAllocation&)>& fits, Fits when) {
  std::vector<Forms> forms;
  for (const MapGroup& group : groups) forms.push_back(FormsOf(group));
  const bool dear_fits = when == Fits::kWhenDear;
  double cheap = -40, dear = 40;  // log10 of the price
  GroupAllocation best = Allocate(forms, std::pow(10.0, dear_fits ? dear : cheap));
  constexpr int kRounds = 60;
  for (int i = 0; i < kRounds; ++i) {
    const double middle = (cheap + dear) / 2;
    GroupAllocation allocation = Allocate(forms, std::pow(10.0, middle));
    const bool fit = fits(allocation);
    (fit == dear_fits ? dear : cheap) = middle;
    if (fit) best = std::move(allocation);
  }
  return best;
}

}  // namespace

std::optional<MapGroup> HalfResolution(const MapGroup& group) {
  const int n = group.edge_samples;
  if (n < 5 || n % 2 == 0) return std::nullopt;
  const int half = (n + 1) / 2, samples = PatchSampleCount(n), fewer = PatchSampleCount(half);
  const WeightedVectors& from = group.vectors;
  const bool by_corner = from.segments == 3;  // else three channels a sample
  MapGroup coarse{half,
                  group.owners,
                  {3 * fewer, from.segments, {}, from.weights},
                  PatchBytes(half),
                  group.lost};
  coarse.vectors.values.resize(group.owners.size() * 3 * fewer);
  for (size_t i = 0; i < group.owners.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      const auto at = [by_corner, c](int sample, int count) {
        return by_corner ? c * count + sample : 3 * sample + c;
      };
      std::vector<float> patch(samples);
      for (int s = 0; s < samples; ++s) {
        patch[s] = from.values[i * from.dimensions + at(s, samples)];
      }
      const std::vector<float> halved = SubsamplePatch(patch, n, (n + 1) / 2);
      for (int s = 0; s < fewer; ++s) {
        coarse.vectors.values[i * coarse.vectors.dimensions + at(s, fewer)] = halved[s];
      }
      const std::vector<float> back = InterpolatePatch(halved, half, n);
      double lost = 0;
      for (int s = 0; s < samples; ++s) {
        lost +=
            (static_cast<double>(back[s]) - patch[s]) * (static_cast<double>(back[s]) - patch[s]);
      }
      coarse.lost += lost * (by_corner ? from.weights[3 * i + c] : from.weights[i]);
    }
  }
  // A sample of the coarse patch stands for as many of the fine one.
  const float share = static_cast<float>(samples) / static_cast<float>(fewer);
  for (float& weight : coarse.vectors.weights) weight *= share;
  return coarse;
}

MapScales MeasureMapScales(const LightFieldModel& model) {
  const size_t vertices = model.vertex_terms.size();
  MapScales scales{std::vector<float>(model.terms * vertices, 0.f),
                   std::vector<float>(model.terms * vertices, 0.f)};
  const VertexRings rings = ComputeVertexRings(model.mesh);
  ParallelFor(0, static_cast<int64_t>(vertices), [&](int64_t v) {
    const auto ring = rings.Ring(v);
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
    MapGroup group{n, std::move(triangles), {3 * PatchSampleCount(n), 1, {}, {}}, PatchBytes(n), 0};
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
    MapGroup group{n, std::move(triangles), {3 * samples, 3, {}, {}}, PatchBytes(n), 0};
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
  MapGroup group{0, {}, {length, 1, {}, {}}, length, 0};
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

GroupAllocation ChooseForBytes(std::span<const MapGroup> groups, int64_t max_bytes) {
  return AllocateToFit(
      groups, [&](const GroupAllocation& a) { return a.bytes <= max_bytes; }, Fits::kWhenDear);
}

GroupAllocation ChooseForDistortion(std::span<const MapGroup> groups, double max_distortion) {
  return AllocateToFit(
      groups, [&](const GroupAllocation& a) { return a.distortion <= max_distortion; },
      Fits::kWhenCheap);
}

}  // namespace lfm
