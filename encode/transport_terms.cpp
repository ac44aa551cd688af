// SPDX-License-Identifier: BSD-3-Clause
#include "encode/transport_terms.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "resample/light_field.h"

namespace lfm::transport {
namespace {

// Three planes of `count` opponent colours become RGB.
void MixChannels(std::vector<float>& planes, size_t count) {
  const Eigen::Matrix3f& m = OpponentColors();
  float* __restrict gray = planes.data();
  float* __restrict red = gray + count;
  float* __restrict green = red + count;
  for (size_t q = 0; q < count; ++q) {
    const float a = gray[q], b = red[q], c = green[q];
    gray[q] = m(0, 0) * a + m(0, 1) * b + m(0, 2) * c;
    red[q] = m(1, 0) * a + m(1, 1) * b + m(1, 2) * c;
    green[q] = m(2, 0) * a + m(2, 1) * b + m(2, 2) * c;
  }
}

void ClampToNonnegative(std::vector<float>& values) {
  for (float& value : values) value = value > 0 ? value : 0;
}

float MaxAbs(const std::vector<float>& values) {
  return Eigen::Map<const Eigen::ArrayXf>(values.data(), static_cast<Eigen::Index>(values.size()))
      .abs()
      .maxCoeff();
}

// Everything that is used again from map to map.
class MapDecoder {
 public:
  explicit MapDecoder(const MapContext& context)
      : context_(context), view_block_(MakeBlock(context.geometry.grid, 3, false)) {}

  TermMaps Term(const Ring& ring, double sigma, float step, RangeDecoder& coder,
                TermModels& models) {
    DecodeSurface(ring, static_cast<float>(step / sigma), coder, models);
    DecodeView(step, coder, models);
    if (context_.geometry.mean_in_terms) {
      ClampToNonnegative(surface_);
      ClampToNonnegative(view_);
    }
    const Extent extent = SurfaceExtent(ring.edge_samples, surface_);
    const AlphaSplit split = SplitAlpha(extent.max_abs(), MaxAbs(view_));
    for (float& value : view_) value *= static_cast<float>(split.view);
    TermMaps maps;
    QuantizeSurface(ring.edge_samples, ring.shared, surface_, extent, split.surface, maps);
    QuantizeView(view_, maps);
    return maps;
  }

  // The opponent colours of a triangle's mean view less its predicted colour, as three planes.
  const std::vector<float>& MeanPlanes(const CoefficientBlock& block, float step) {
    const auto count = static_cast<size_t>(PatchSampleCount(block.side));
    view_.resize(3 * count);
    for (int c = 0; c < 3; ++c) {
      Dequantize(block, c, step);
      context_.transform.FromTriangle(block.side, low_, std::span(view_).subspan(c * count, count),
                                      buffers_);
    }
    MixChannels(view_, count);
    return view_;
  }

 private:
  // The low frequencies that hold anything.
  void Dequantize(const CoefficientBlock& block, int channel, float step) {
    low_.used = std::min(block.diagonals[channel], block.side);
    low_.values.resize(static_cast<size_t>(low_.used) * low_.used);
    for (int row = 0; row < low_.used; ++row) {
      for (int column = 0; column < low_.used; ++column) {
        low_.At(row, column) = step * static_cast<float>(block.At(channel, row, column));
      }
    }
  }

  void DecodeSurface(const Ring& ring, float step, RangeDecoder& coder, TermModels& models) {
    surface_.resize(ring.samples);
    patches_.clear();
    float* patch = surface_.data();
    for (size_t i = 0; i < ring.triangles.size(); ++i) {
      const int n = ring.edge_samples[i];
      if (patch_block_.side != n) patch_block_ = MakeBlock(n, 1, true);
      models.surface[SizeClass(n)].Decode(coder, patch_block_);
      Dequantize(patch_block_, 0, step);
      const std::span<float> values(patch, static_cast<size_t>(PatchSampleCount(n)));
      context_.transform.FromTriangle(n, low_, values, buffers_);
      // Maps end at the far edges of a ring, where the triangles beyond do not know the vertex.
      const int far_edge = (ring.corners[i] + 1) % 3;
      for (int along = 0; along < n; ++along) values[EdgeSampleIndex(n, far_edge, along)] = 0;
      patches_.push_back({patch, true});
      patch += values.size();
    }
    MakeContinuous(ring.shared, 1, patches_);
  }

  void DecodeView(float step, RangeDecoder& coder, TermModels& models) {
    const int grid = context_.geometry.grid;
    const auto count = static_cast<size_t>(grid) * grid;
    models.view.Decode(coder, view_block_);
    view_.resize(3 * count);
    for (int c = 0; c < 3; ++c) {
      Dequantize(view_block_, c, step);
      context_.transform.FromSquare(grid, low_, std::span(view_).subspan(c * count, count),
                                    buffers_);
    }
    MixChannels(view_, count);
  }

  const MapContext& context_;
  CoefficientBlock view_block_, patch_block_;
  LowFrequencies low_;
  TransformBuffers buffers_;
  std::vector<float> surface_, view_;
  std::vector<PatchValues> patches_;
};

}  // namespace

float TakeStep(Stream& stream) {
  float step = 0;
  stream.Require(stream.Take(step) && step > 0 && step <= kMostStep, "a step is out of range");
  return step;
}

int64_t TexelBudget(const Stream& stream) {
  return static_cast<int64_t>(stream.bytes.size() + 1) * kTexelsAByte;
}

void DecodeChunk(const MapContext& context, std::span<const TermPart> parts,
                 const std::string& name, std::vector<std::vector<TermMaps>>& maps) {
  if (parts.empty()) return;
  const int64_t view_texels = 3 * int64_t{context.geometry.grid} * context.geometry.grid;
  const uint32_t first = parts.front().header.first_vertex;
  // Of vertices that have terms alone: a ring takes much more memory than its bits.
  std::vector<std::optional<Ring>> rings(parts.front().header.count);
  MapDecoder decoder(context);
  for (const TermPart& part : parts) {
    Stream stream{part.bytes, name};
    int64_t sigma = 0, texels = TexelBudget(stream);
    const float step = TakeStep(stream);
    RangeDecoder coder(stream.bytes);
    TermModels models;
    bool before = true;
    for (uint32_t i = 0; i < rings.size(); ++i) {
      std::vector<TermMaps>& own = maps[first + i];
      if (own.size() != part.header.term) continue;
      const bool has = coder.Decode(models.has[before]);
      stream.Require(!coder.overrun(), "a term is too short");
      before = has;
      if (!has) continue;
      const int vertex = static_cast<int>(first + i);
      if (!rings[i]) {
        rings[i] =
            MakeRing(context.geometry.mesh, context.rings, context.geometry.edge_samples, vertex);
      }
      stream.Require(rings[i]->samples > 0, "a vertex of no triangle has terms");
      texels -= rings[i]->samples + view_texels;
      stream.Require(texels > 0, "a term is too short for its maps");
      sigma += Unzigzag(models.sigma.Decode(coder));
      stream.Require(std::abs(sigma) <= kMostSigma, "the scale of a term is too large");
      own.push_back(decoder.Term(*rings[i], SigmaOf(static_cast<int>(sigma)), step, coder, models));
      stream.Require(!coder.overrun(), "a term is too short");
    }
  }
}

std::vector<std::vector<float>> DecodeMean(const MapContext& context, Stream stream) {
  const float step = TakeStep(stream);
  const Geometry& geometry = context.geometry;
  const std::vector<Eigen::Vector3i> neighbors = ComputeTriangleNeighbors(geometry.mesh);
  std::vector<Eigen::Vector3f> colors(geometry.edge_samples.size());
  std::vector<std::vector<float>> means(geometry.edge_samples.size());
  RangeDecoder coder(stream.bytes);
  std::array<CoefficientModels, kSizeClasses> models;
  MapDecoder decoder(context);
  CoefficientBlock block;
  for (int t = 0; t < static_cast<int>(means.size()); ++t) {
    const int n = geometry.edge_samples[t];
    if (block.side != n) block = MakeBlock(n, 3, true);
    models[SizeClass(n)].Decode(coder, block);
    stream.Require(!coder.overrun(), "its mean view is too short");
    const Eigen::Vector3f predicted = PredictMean(neighbors[t], t, colors);
    colors[t] = predicted + MeanOffset(block, step);
    const std::vector<float>& planes = decoder.MeanPlanes(block, step);
    const size_t count = planes.size() / 3;
    means[t].resize(planes.size());
    for (size_t s = 0; s < count; ++s) {
      for (int c = 0; c < 3; ++c) means[t][3 * s + c] = planes[c * count + s] + predicted[c];
    }
  }
  return means;
}

}  // namespace lfm::transport
