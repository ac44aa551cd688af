// SPDX-License-Identifier: BSD-3-Clause
#include "resample/dense_light_field.h"

#include <array>
#include <cerrno>
#include <fstream>

#include "core/atomic_file.h"
#include "core/error.h"

namespace lfm {
namespace {

constexpr std::array<char, 8> kMagic = {'L', 'F', 'M', 'D', 'N', 'S', '\r', '\n'};

struct DenseHeader {
  std::array<char, 8> magic;
  uint32_t version;
  uint32_t grid;
  uint64_t triangles;
};

void Check(const std::ofstream& stream, const std::filesystem::path& file) {
  if (!stream) FailWriting(file, errno);
}

[[noreturn]] void FailReading(const std::filesystem::path& file) {
  throw Error(file.string() + ": is not a complete dense light field; write it again");
}

}  // namespace

std::vector<float> DenseBlock(const LightField& light_field, int triangle, int corner) {
  const TrianglePatch patch = light_field.Patch(triangle);
  const size_t entries = static_cast<size_t>(light_field.grid()) * light_field.grid();
  const size_t rows = static_cast<size_t>(PatchSampleCount(patch.edge_samples)) * 3;
  std::vector<float> block(rows * entries, 0.0F);
  const size_t views = patch.photos.size();
  if (views == 0) return block;
  LightField::WeightBuffer buffer;
  const ViewWeights weights = light_field.Weights(triangle, corner, buffer);
  for (size_t row = 0; row < rows; ++row) {
    const uint16_t* values = &patch.values[row * views];
    for (size_t q = 0; q < entries; ++q) {
      float sum = 0;
      for (size_t k = 0; k < 3; ++k) {
        sum += weights.weight[3 * q + k] * static_cast<float>(values[weights.view[3 * q + k]]);
      }
      block[row * entries + q] = sum / LightField::kOne;
    }
  }
  return block;
}

void WriteDense(const LightField& light_field, const std::filesystem::path& file,
                Progress& progress) {
  progress.Start("writing the dense matrix", light_field.triangle_count());
  WriteFileAtomically(file, [&](const std::filesystem::path& temporary) {
    std::ofstream stream(temporary, std::ios::binary);
    const auto write = [&](const void* data, size_t size) {
      stream.write(static_cast<const char*>(data), static_cast<std::streamsize>(size));
      Check(stream, file);
    };
    const DenseHeader header{kMagic, 1, static_cast<uint32_t>(light_field.grid()),
                             static_cast<uint64_t>(light_field.triangle_count())};
    write(&header, sizeof(header));
    for (int t = 0; t < light_field.triangle_count(); ++t) {
      const auto edge_samples = static_cast<uint32_t>(light_field.Patch(t).edge_samples);
      write(&edge_samples, sizeof(edge_samples));
    }
    for (int t = 0; t < light_field.triangle_count(); ++t) {
      for (int corner = 0; corner < 3; ++corner) {
        const std::vector<float> block = DenseBlock(light_field, t, corner);
        write(block.data(), block.size() * sizeof(float));
      }
      progress.Advance();
    }
    stream.close();
    Check(stream, file);
  });
}

std::vector<float> ReadDenseBlock(const std::filesystem::path& file, int triangle, int corner) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw Error(file.string() + ": cannot be read; check the name");
  std::error_code error;
  const uint64_t size = std::filesystem::file_size(file, error);
  DenseHeader header;
  stream.read(reinterpret_cast<char*>(&header), sizeof(header));
  const bool valid = stream && !error && header.magic == kMagic && header.version == 1 &&
                     header.grid >= 2 && header.grid <= 256 && triangle >= 0 && corner >= 0 &&
                     corner < 3 && static_cast<uint64_t>(triangle) < header.triangles &&
                     header.triangles <= size / sizeof(uint32_t);
  if (!valid) FailReading(file);
  std::vector<uint32_t> edge_samples(header.triangles);
  stream.read(reinterpret_cast<char*>(edge_samples.data()),
              static_cast<std::streamsize>(edge_samples.size() * sizeof(uint32_t)));
  uint64_t place = sizeof(header) + edge_samples.size() * sizeof(uint32_t);
  const auto block_size = [&](int t) {
    const uint64_t n = edge_samples[static_cast<size_t>(t)];
    return n * (n + 1) / 2 * 3 * header.grid * header.grid * sizeof(float);
  };
  for (int t = 0; t < triangle; ++t) place += 3 * block_size(t);
  place += static_cast<uint64_t>(corner) * block_size(triangle);
  if (!stream || place > size || block_size(triangle) > size - place) FailReading(file);
  std::vector<float> block(block_size(triangle) / sizeof(float));
  stream.seekg(static_cast<std::streamoff>(place));
  stream.read(reinterpret_cast<char*>(block.data()),
              static_cast<std::streamsize>(block.size() * sizeof(float)));
  if (!stream) FailReading(file);
  return block;
}

}  // namespace lfm
