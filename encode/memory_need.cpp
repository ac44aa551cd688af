// SPDX-License-Identifier: BSD-3-Clause
#include "encode/memory_need.h"

#include <algorithm>
#include <string>

#include "core/process_memory.h"

namespace lfm {
namespace {

constexpr int64_t kMib = 1 << 20, kMostFileBytes = 1024 * kMib, kFileShare = 8;

}  // namespace

int64_t ResidentFileBytes(const EncodeOptions& options) {
  if (options.memory_mib == 0) return kMostFileBytes;  // the system takes pages back
  return std::min(kMostFileBytes, options.memory_mib * kMib / kFileShare);
}

int MostTerms(const EncodeOptions& options) {
  constexpr int kNonnegative = 3;  // they do not add up one by one: no choice a vertex
  if (options.terms != EncodeOptions::kAsNeeded) return options.terms;
  return options.factorization == Factorization::kNmf ? kNonnegative : options.max_terms;
}

int64_t EncodeBytes(const LightFieldSource& source, std::span<const int> edge_samples,
                    const EncodeOptions& options) {
  // Terms are held once while they are chosen, and in three models at most while resolutions are.
  constexpr int64_t kCopies = 4, kBase = int64_t{64} << 20;
  constexpr int64_t kBytesATriangle = 1000, kBytesAVertex = 1500, kBytesATerm = 150;
  int64_t samples = 0;
  for (const int n : edge_samples) samples += PatchSampleCount(n);
  const auto vertices = static_cast<int64_t>(source.mesh.vertices.size());
  const int64_t terms = MostTerms(options), directions = int64_t{source.grid} * source.grid;
  const int64_t maps = 3 * samples * (terms + 1) + 3 * directions * vertices * terms;
  return kBase + kCopies * maps + kBytesATriangle * static_cast<int64_t>(edge_samples.size()) +
         (kBytesAVertex + kBytesATerm * terms) * vertices;
}

void RequireMemory(const LightFieldSource& source, std::span<const int> edge_samples,
                   const EncodeOptions& options) {
  int64_t bytes = EncodeBytes(source, edge_samples, options);
  // With the file the limit has to be 8/7 of all else.
  if (options.memory_mib > 0) {
    bytes += std::min(kMostFileBytes, (ResidentMemoryBytes() + bytes) / (kFileShare - 1));
  }
  MemoryLimit(options.memory_mib, "--encode-memory-mib")
      .Require(bytes,
               "encoding " + std::to_string(edge_samples.size()) + " triangles of " +
                   std::to_string(source.grid) + " x " + std::to_string(source.grid) +
                   " directions with up to " + std::to_string(MostTerms(options)) + " terms",
               "or take fewer terms (--max-terms, --terms), directions (lfm-resample --view-grid) "
               "or triangles (lfm-mesh --triangle-count)");
}

}  // namespace lfm
