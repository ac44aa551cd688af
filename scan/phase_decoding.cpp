// SPDX-License-Identifier: BSD-3-Clause
#include "scan/phase_decoding.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "scan/frame_noise.h"
#include "scan/neighbour_check.h"
#include "scan/period_choice.h"
#include "scan/phase_fit.h"

namespace lfm {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr size_t kBlock = 512;
constexpr float kLikelihoodPerBit = 23;
// A residual this many times the noise happens once in 10 000 pixels.
constexpr double kUnlikelyResidual = 15;
constexpr double kLeastSigmaPx = 1e-4;
// Sigma says what little modulation costs a fringe: it bears half of what edges need.
constexpr double kModulationOfFringes = 0.5;

double LeastModulation(const DecodeOptions& options) {
  return kModulationOfFringes * options.min_modulation;
}

/// Linear values of a block's frames and which pixels are at their ceiling.
struct Block {
  size_t begin = 0, count = 0;
  std::vector<PhaseFits> periods;
  std::vector<float> bits;   ///< soft Gray bits, bit after bit
  std::vector<float> pairs;  ///< pattern + inverse, bit after bit
  std::vector<uint8_t> saturated;
};

class BlockReader {
 public:
  BlockReader(const FramePlanes& planes, const AxisFrames& frames, const PixelLight& light)
      : planes_(planes), frames_(frames), light_(light) {}

  Block Read(size_t begin) const {
    Block block;
    block.begin = begin;
    block.count = std::min(kBlock, planes_.pixels() - begin);
    block.saturated.assign(block.count, 0);
    ReadBits(block);
    std::vector<float> values;
    for (const PeriodFrames& period : frames_.phases) {
      values.resize(period.steps.size() * kBlock);
      for (size_t i = 0; i < period.steps.size(); ++i) {
        planes_.ReadLinear(period.steps[i], begin, block.count, &values[i * kBlock],
                           block.saturated.data());
      }
      FitPhases(values.data(), kBlock, static_cast<int>(period.steps.size()), block.count,
                block.periods.emplace_back());
    }
    return block;
  }

 private:
  void ReadBits(Block& block) const {
    block.bits.resize(frames_.gray.size() * kBlock);
    const bool pairs = frames_.HasAllInverses();
    if (pairs) block.pairs.resize(block.bits.size());
    std::vector<float> pattern(kBlock), inverse(kBlock);
    for (size_t bit = 0; bit < frames_.gray.size(); ++bit) {
      float* out = &block.bits[bit * kBlock];
      const int p = frames_.gray[bit], q = frames_.inverse[bit];
      if (p >= 0) Read(p, block, pattern);
      if (q >= 0) Read(q, block, inverse);
      for (size_t i = 0; i < block.count; ++i) {
        const size_t at = block.begin + i;
        const float both = 2 * light_.white[at] - light_.contrast[at];
        const float a = p >= 0 ? pattern[i] : both - inverse[i];
        const float b = q >= 0 ? inverse[i] : both - pattern[i];
        const float share = (a - b) / light_.contrast[at];
        out[i] = std::isfinite(share) ? std::clamp(share, -1.0F, 1.0F) : 0.0F;
        if (pairs) block.pairs[bit * kBlock + i] = a + b;
      }
    }
  }

  void Read(int frame, Block& block, std::vector<float>& out) const {
    planes_.ReadLinear(frame, block.begin, block.count, out.data(), block.saturated.data());
  }

  const FramePlanes& planes_;
  const AxisFrames& frames_;
  const PixelLight& light_;
};

NoiseSample SpreadOf(const std::vector<float>& values, size_t first, size_t step, size_t count) {
  double sum = 0, squares = 0;
  for (size_t i = 0; i < count; ++i) {
    const double v = values[first + i * step] - values[first];
    sum += v;
    squares += v * v;
  }
  const double n = static_cast<double>(count);
  return {static_cast<float>(values[first] + sum / n),
          static_cast<float>(std::max(0.0, squares - sum * sum / n) / std::max(1.0, n - 1))};
}

/// Where the noise of a frame is read off, best first.
enum class NoiseSource { kPairs, kResidual, kOffsets, kNone };

NoiseSource SourceOf(const AxisFrames& frames) {
  if (frames.gray.size() > 1 && frames.HasAllInverses()) return NoiseSource::kPairs;
  const int steps = static_cast<int>(frames.phases.front().steps.size());
  if (ResidualFreedom(steps) > 0) return NoiseSource::kResidual;
  return frames.phases.size() > 1 ? NoiseSource::kOffsets : NoiseSource::kNone;
}

NoiseSample SampleNoise(const Block& block, size_t i, NoiseSource source, int steps) {
  if (source == NoiseSource::kPairs) {
    const NoiseSample pair = SpreadOf(block.pairs, i, kBlock, block.pairs.size() / kBlock);
    return {pair.mean / 2, pair.variance / 2};
  }
  const PhaseFits& shortest = block.periods.front();
  if (source == NoiseSource::kResidual) return {shortest.offset[i], shortest.residual[i]};
  std::vector<float> offsets;
  for (const PhaseFits& fits : block.periods) offsets.push_back(fits.offset[i]);
  const NoiseSample spread = SpreadOf(offsets, 0, 1, offsets.size());
  return {spread.mean, spread.variance * static_cast<float>(steps)};
}

/// What a sample of the pixels says about all: the frames' noise and the projector's curve.
struct FrameFacts {
  NoiseSource source = NoiseSource::kNone;
  FrameNoise noise;
  PhaseCorrection correction;
};

FrameFacts LearnFacts(const BlockReader& reader, const AxisFrames& frames, const PixelLight& light,
                      double min_modulation) {
  constexpr size_t kBlocks = 48;
  FrameFacts facts;
  facts.source = SourceOf(frames);
  const int steps = static_cast<int>(frames.phases.front().steps.size());
  const size_t blocks = (light.usable.size() + kBlock - 1) / kBlock;
  const size_t count = std::min(blocks, kBlocks);
  std::vector<NoiseSample> samples;
  std::vector<float> phases;
  for (size_t b = 0; b < count; ++b) {
    const Block block = reader.Read((2 * b + 1) * blocks / (2 * count) * kBlock);
    const PhaseFits& fits = block.periods.front();
    for (size_t i = 0; i < block.count; ++i) {
      if (!light.usable[block.begin + i] || block.saturated[i]) continue;
      const float amplitude = std::hypot(fits.cosine[i], fits.sine[i]);
      if (!(2 * amplitude >= min_modulation * light.contrast[block.begin + i])) continue;
      phases.push_back(std::atan2(fits.sine[i], fits.cosine[i]));
      if (facts.source != NoiseSource::kNone) {
        samples.push_back(SampleNoise(block, i, facts.source, steps));
      }
    }
  }
  const int freedom = facts.source == NoiseSource::kPairs ? static_cast<int>(frames.gray.size()) - 1
                      : facts.source == NoiseSource::kResidual
                          ? ResidualFreedom(steps)
                          : std::max(1, static_cast<int>(frames.phases.size()) - 1);
  facts.noise = FitFrameNoise(std::move(samples), freedom);
  // With more steps the harmonics that could disturb are weak, and the correction is noise.
  if (steps <= 5) facts.correction = EstimateCorrection(phases, steps);
  return facts;
}

class PixelDecoder {
 public:
  PixelDecoder(const AxisFrames& frames, const PixelLight& light, const FrameFacts& facts,
               const DecodeOptions& options)
      : frames_(frames), light_(light), facts_(facts), options_(options), chooser_(frames) {
    evidence_.bits.resize(frames.gray.size());
    evidence_.phases.resize(frames.phases.size() - 1);
    evidence_.variances.resize(frames.phases.size() - 1);
  }

  void Decode(const Block& block, size_t i, AxisCoordinates& out) {
    const size_t p = block.begin + i;
    if (!light_.usable[p] || block.saturated[i]) return;
    const PhaseFits& fits = block.periods.front();
    const double amplitude = std::hypot(fits.cosine[i], fits.sine[i]);
    const double modulation = 2 * amplitude / light_.contrast[p];
    if (!(modulation >= LeastModulation(options_)) || !std::isfinite(modulation)) return;
    const std::optional<ChosenPeriod> chosen = Choose(block, i);
    if (!chosen || !(chosen->margin >= options_.min_margin * kLikelihoodPerBit)) return;
    const double period = frames_.phases.front().period_px;
    const double sigma = period / kTurn * std::sqrt(PhaseVariance(fits, i));
    const double certainty = std::clamp(chosen->margin / (0.8 * kLikelihoodPerBit), 0.0, 1.0);
    out.position[p] = static_cast<float>(chosen->position);
    out.sigma[p] = static_cast<float>(std::clamp(sigma, kLeastSigmaPx, period));
    out.confidence[p] = static_cast<float>(certainty * std::clamp(modulation / 0.8, 0.0, 1.0));
  }

 private:
  /// Of the phase, in square radians.
  double PhaseVariance(const PhaseFits& fits, size_t i) const {
    const int steps = static_cast<int>(frames_.phases.front().steps.size());
    const double a2 = std::pow(fits.cosine[i], 2) + std::pow(fits.sine[i], 2);
    const double noise = facts_.noise.Variance(fits.offset[i]);
    double variance = noise;
    if (facts_.source == NoiseSource::kResidual && fits.residual[i] > kUnlikelyResidual * noise) {
      variance = fits.residual[i];
    }
    return 2.0 / steps * variance / std::max(a2, 1e-30);
  }

  std::optional<ChosenPeriod> Choose(const Block& block, size_t i) {
    for (size_t bit = 0; bit < evidence_.bits.size(); ++bit) {
      evidence_.bits[bit] = block.bits[bit * kBlock + i];
    }
    for (size_t j = 1; j < block.periods.size(); ++j) {
      const PhaseFits& fits = block.periods[j];
      const float phase = std::atan2(fits.sine[i], fits.cosine[i]);
      if (!std::isfinite(phase)) return std::nullopt;
      evidence_.phases[j - 1] = phase;
      evidence_.variances[j - 1] = static_cast<float>(PhaseVariance(fits, i));
    }
    const PhaseFits& fits = block.periods.front();
    const double phase = facts_.correction.Apply(std::atan2(fits.sine[i], fits.cosine[i]));
    const double period = frames_.phases.front().period_px;
    const double fraction = period * (phase / kTurn);
    return chooser_.Choose(fraction < -1 ? fraction + period : fraction, evidence_);
  }

  const AxisFrames& frames_;
  const PixelLight& light_;
  const FrameFacts& facts_;
  const DecodeOptions& options_;
  PeriodChooser chooser_;
  PeriodEvidence evidence_;
};

}  // namespace

AxisCoordinates DecodePhaseAxis(const FramePlanes& planes, const AxisFrames& frames,
                                const PixelLight& light, const DecodeOptions& options) {
  const BlockReader reader(planes, frames, light);
  const FrameFacts facts = LearnFacts(reader, frames, light, LeastModulation(options));
  AxisCoordinates out;
  out.position.assign(planes.pixels(), 0);
  out.sigma.assign(planes.pixels(), 0);
  out.confidence.assign(planes.pixels(), 0);
  PixelDecoder decoder(frames, light, facts, options);
  for (size_t begin = 0; begin < planes.pixels(); begin += kBlock) {
    const Block block = reader.Read(begin);
    for (size_t i = 0; i < block.count; ++i) decoder.Decode(block, i, out);
  }
  RejectContradicted(planes.width(), planes.height(), frames.phases.front().period_px / 2.0, out);
  return out;
}

}  // namespace lfm
