// SPDX-License-Identifier: BSD-3-Clause
#include "resample/light_field.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/error.h"
#include "core/mapped_file.h"
#include "resample/light_field_reader.h"
#include "resample/weight_codec.h"

namespace lfm {

struct LightField::State {
  MappedFile mapping;            ///< empty for content in memory
  std::vector<std::byte> owned;  ///< empty for a file
  LightFieldContent content;
};

int PatchSampleCount(int n) { return n * (n + 1) / 2; }

int PatchSampleIndex(int n, int i, int j) { return j * n - j * (j - 1) / 2 + i; }

Eigen::Vector3d PatchSampleWeights(int n, int i, int j) {
  const double step = 1.0 / (n - 1);
  return {(n - 1 - i - j) * step, i * step, j * step};
}

int ChooseEdgeSamples(double samples, int max_edge_samples) {
  constexpr int kSmallest = 4, kLargest = 193;
  int n = kSmallest;
  while (PatchSampleCount(n) < samples && 2 * n - 1 <= std::min(max_edge_samples, kLargest)) {
    n = 2 * n - 1;
  }
  return n;
}

LightField::LightField(std::unique_ptr<State> state) : state_(std::move(state)) {}
LightField::~LightField() = default;
LightField::LightField(LightField&&) noexcept = default;
LightField& LightField::operator=(LightField&&) noexcept = default;

LightField LightField::Open(const std::filesystem::path& file) {
  auto state = std::make_unique<State>();
  state->mapping = MappedFile(file);
  state->content = ParseLightField(state->mapping.bytes(), file.string());
  return LightField(std::move(state));
}

LightField LightField::FromMemory(std::vector<std::byte> bytes, const std::string& name) {
  auto state = std::make_unique<State>();
  state->owned = std::move(bytes);
  state->content = ParseLightField(state->owned, name);
  return LightField(std::move(state));
}

const TriangleMesh& LightField::mesh() const { return state_->content.mesh; }
const std::vector<Eigen::Matrix3d>& LightField::vertex_frames() const {
  return state_->content.vertex_frames;
}
const std::vector<std::string>& LightField::photo_ids() const { return state_->content.photo_ids; }
DirectionMap LightField::direction_map() const { return state_->content.direction_map; }
int LightField::grid() const { return state_->content.grid; }
int LightField::triangle_count() const { return static_cast<int>(state_->content.records.size()); }

TrianglePatch LightField::Patch(int triangle) const {
  const LightFieldRecord& record = state_->content.records[static_cast<size_t>(triangle)];
  return {record.edge_samples, record.photos, record.values};
}

ViewWeights LightField::Weights(int triangle, int corner, WeightBuffer& buffer) const {
  const LightFieldRecord& record = state_->content.records[static_cast<size_t>(triangle)];
  if (record.photos.empty()) return {};
  DecodeWeights(record.weights[static_cast<size_t>(corner)], buffer);
  return {buffer.view, buffer.weight, buffer.seen};
}

int64_t LightField::DenseBytes() const {
  int64_t samples = 0;
  for (const auto& record : state_->content.records) {
    samples += PatchSampleCount(record.edge_samples);
  }
  return 3 * samples * grid() * grid();
}

}  // namespace lfm
