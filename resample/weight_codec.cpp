// SPDX-License-Identifier: BSD-3-Clause
#include "resample/weight_codec.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <unordered_map>

#include "core/error.h"

namespace lfm {
namespace {

constexpr int kUnit = 65535;

struct Counts {
  uint32_t rows = 0;
  uint32_t entries = 0;
};

/// One of the different mixtures of a corner: a Delaunay face, an edge of the hull, one view.
struct Row {
  std::array<uint16_t, 3> view;
  uint16_t seen;
};

struct Entry {
  uint16_t row;
  std::array<uint16_t, 2> weight;
};

size_t PaddedSize(const Counts& counts) {
  const size_t size =
      sizeof(Counts) + size_t{counts.rows} * sizeof(Row) + size_t{counts.entries} * sizeof(Entry);
  return (size + 7) / 8 * 8;
}

template <typename T>
T Load(const std::byte* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

uint64_t Key(const Row& row) {
  return uint64_t{row.view[0]} | uint64_t{row.view[1]} << 16 | uint64_t{row.view[2]} << 32 |
         uint64_t{row.seen} << 48;
}

std::array<uint16_t, 2> Quantize(const float* weight) {
  const double sum = double{weight[0]} + weight[1] + weight[2];
  const bool valid =
      weight[0] >= 0 && weight[1] >= 0 && weight[2] >= 0 && std::isfinite(sum) && sum > 0;
  if (!valid) throw Error("light field: a view weight is not a weight", ErrorKind::kSystem);
  const auto first = static_cast<int>(std::lround(weight[0] / sum * kUnit));
  const auto both = static_cast<int>(std::lround((double{weight[0]} + weight[1]) / sum * kUnit));
  return {static_cast<uint16_t>(first), static_cast<uint16_t>(std::max(both, first) - first)};
}

void CheckBuffer(const LightField::WeightBuffer& weights, size_t view_count) {
  const size_t entries = weights.seen.size();
  if (weights.view.size() != 3 * entries || weights.weight.size() != 3 * entries) {
    throw Error("light field: view weights of different lengths", ErrorKind::kSystem);
  }
  for (const uint16_t view : weights.view) {
    if (view >= view_count) throw Error("light field: no such view", ErrorKind::kSystem);
  }
}

}  // namespace

void AppendWeights(const LightField::WeightBuffer& weights, size_t view_count,
                   std::vector<std::byte>& bytes) {
  CheckBuffer(weights, view_count);
  std::vector<Row> rows;
  std::vector<Entry> entries(weights.seen.size());
  std::unordered_map<uint64_t, uint16_t> row_of;
  for (size_t q = 0; q < entries.size(); ++q) {
    const uint16_t* view = &weights.view[3 * q];
    const Row row{{view[0], view[1], view[2]}, weights.seen[q] != 0 ? uint16_t{1} : uint16_t{0}};
    const auto [place, is_new] = row_of.try_emplace(Key(row), static_cast<uint16_t>(rows.size()));
    if (is_new) rows.push_back(row);
    entries[q] = {place->second, Quantize(&weights.weight[3 * q])};
  }
  if (rows.size() > 65536) {
    throw Error("light field: more than 65536 different view weights", ErrorKind::kSystem);
  }
  const Counts counts{static_cast<uint32_t>(rows.size()), static_cast<uint32_t>(entries.size())};
  const size_t start = bytes.size();
  bytes.resize(start + PaddedSize(counts));
  std::byte* out = bytes.data() + start;
  std::memcpy(out, &counts, sizeof(Counts));
  if (entries.empty()) return;
  std::memcpy(out + sizeof(Counts), rows.data(), rows.size() * sizeof(Row));
  std::memcpy(out + sizeof(Counts) + rows.size() * sizeof(Row), entries.data(),
              entries.size() * sizeof(Entry));
}

size_t CheckWeights(std::span<const std::byte> bytes, size_t entry_count, size_t view_count,
                    const std::string& where) {
  const auto fail = [&]() {
    throw Error(where + ": view weights are damaged; run lfm-resample again");
  };
  if (bytes.size() < sizeof(Counts)) fail();
  const auto counts = Load<Counts>(bytes.data());
  if (counts.entries != entry_count || counts.rows > 65536) fail();
  const size_t size = PaddedSize(counts);
  if (bytes.size() < size) fail();
  const std::byte* place = bytes.data() + sizeof(Counts);
  for (uint32_t i = 0; i < counts.rows; ++i, place += sizeof(Row)) {
    const auto row = Load<Row>(place);
    for (const uint16_t view : row.view) {
      if (view >= view_count) fail();
    }
    if (row.seen > 1) fail();
  }
  for (uint32_t i = 0; i < counts.entries; ++i, place += sizeof(Entry)) {
    const auto entry = Load<Entry>(place);
    if (entry.row >= counts.rows || entry.weight[0] + entry.weight[1] > kUnit) fail();
  }
  return size;
}

void DecodeWeights(std::span<const std::byte> bytes, LightField::WeightBuffer& buffer) {
  constexpr float kScale = 1.0F / kUnit;
  const auto counts = Load<Counts>(bytes.data());
  const std::byte* rows = bytes.data() + sizeof(Counts);
  const std::byte* place = rows + size_t{counts.rows} * sizeof(Row);
  buffer.view.resize(3 * size_t{counts.entries});
  buffer.weight.resize(3 * size_t{counts.entries});
  buffer.seen.resize(counts.entries);
  for (size_t q = 0; q < counts.entries; ++q, place += sizeof(Entry)) {
    const auto entry = Load<Entry>(place);
    const auto row = Load<Row>(rows + size_t{entry.row} * sizeof(Row));
    std::copy(row.view.begin(), row.view.end(), &buffer.view[3 * q]);
    const int third = kUnit - entry.weight[0] - entry.weight[1];
    buffer.weight[3 * q] = static_cast<float>(entry.weight[0]) * kScale;
    buffer.weight[3 * q + 1] = static_cast<float>(entry.weight[1]) * kScale;
    buffer.weight[3 * q + 2] = static_cast<float>(third) * kScale;
    buffer.seen[q] = static_cast<uint8_t>(row.seen);
  }
}

}  // namespace lfm
