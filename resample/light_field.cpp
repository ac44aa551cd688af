// SPDX-License-Identifier: BSD-3-Clause
#include "resample/light_field.h"

#include <algorithm>
#include <atomic>
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
  std::string name;
  int64_t most_resident = 0;
  std::atomic<int64_t> resident = 0;  ///< at most so many bytes of the mapping

  /// Before a record of a large file is read.
  const LightFieldRecord& Touch(int triangle) {
    const LightFieldRecord& record = content.records[static_cast<size_t>(triangle)];
    if (static_cast<int64_t>(mapping.bytes().size()) <= most_resident) return record;
    constexpr int64_t kWindow = 1 << 16;  // what the system maps around a page, on both sides
    const auto next = static_cast<size_t>(triangle) + 1;
    const uint64_t end =
        next < content.records.size() ? content.records[next].offset : content.data.size();
    const int64_t bytes = static_cast<int64_t>(end - record.offset) + 2 * kWindow;
    if (resident.fetch_add(bytes) + bytes > most_resident) {
      resident = bytes;
      mapping.Release();
    }
    return record;
  }
};

int PatchSampleIndex(int n, int i, int j) { return j * n - j * (j - 1) / 2 + i; }

Eigen::Vector3d PatchSampleWeights(int n, int i, int j) {
  const double step = 1.0 / (n - 1);
  return {(n - 1 - i - j) * step, i * step, j * step};
}

LightField::LightField(std::unique_ptr<State> state) : state_(std::move(state)) {}
LightField::~LightField() = default;
LightField::LightField(LightField&&) noexcept = default;
LightField& LightField::operator=(LightField&&) noexcept = default;

LightField LightField::Open(const std::filesystem::path& file, int64_t most_resident_bytes) {
  auto state = std::make_unique<State>();
  state->mapping = MappedFile(file);
  state->name = file.string();
  state->most_resident = most_resident_bytes;
  const bool is_large = static_cast<int64_t>(state->mapping.bytes().size()) > most_resident_bytes;
  state->content =
      ParseLightField(state->mapping.bytes(), file.string(), [&](std::span<const std::byte> part) {
        if (is_large) state->mapping.Release(part);
      });
  state->mapping.Release();  // what was read to be checked comes back as triangles are read
  return LightField(std::move(state));
}

LightField LightField::FromMemory(std::vector<std::byte> bytes, const std::string& name) {
  auto state = std::make_unique<State>();
  state->owned = std::move(bytes);
  state->name = name;
  state->content = ParseLightField(state->owned, name, [](std::span<const std::byte>) {});
  return LightField(std::move(state));
}

const std::string& LightField::name() const { return state_->name; }
const TriangleMesh& LightField::mesh() const { return state_->content.mesh; }
const std::vector<Eigen::Matrix3d>& LightField::vertex_frames() const {
  return state_->content.vertex_frames;
}
const std::vector<std::string>& LightField::photo_ids() const { return state_->content.photo_ids; }
DirectionMap LightField::direction_map() const { return state_->content.direction_map; }
int LightField::grid() const { return state_->content.grid; }
int LightField::triangle_count() const { return static_cast<int>(state_->content.records.size()); }

TrianglePatch LightField::Patch(int triangle) const {
  const LightFieldRecord& record = state_->Touch(triangle);
  return {record.edge_samples, state_->content.Photos(record), state_->content.Values(record)};
}

ViewWeights LightField::Weights(int triangle, int corner, WeightBuffer& buffer) const {
  const LightFieldRecord& record = state_->Touch(triangle);
  if (record.views == 0) return {};
  DecodeWeights(state_->content.Weights(record, corner), buffer);
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
