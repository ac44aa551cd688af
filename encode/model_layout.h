// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "encode/light_field_source.h"
#include "encode/model.h"
#include "encode/tiling.h"
#include "encode/vertex_factorization.h"

namespace lfm {

/// A model with pages of the right sizes and nothing in them: patches of `edge_samples` (one a
/// triangle), view tiles, and as many terms as `vertex_terms` says.
LightFieldModel LayOutModel(const LightFieldSource& source, std::span<const int> edge_samples,
                            std::vector<int> vertex_terms, int max_texture_size,
                            PatchSpacing spacing = PatchSpacing::kNeighbors);

/// Black 8-bit RGB pages of these sizes.
std::vector<Image> MakePages(const std::vector<Eigen::Vector2i>& sizes);
/// Writes one channel set of a patch's samples: texel channel `first` on, `count` codes a sample.
void WritePatch(Image& page, const PatchPlacement& placement, const uint8_t* codes, int first,
                int count);

/// The other way.
std::vector<uint8_t> ReadPatch(const Image& page, const PatchPlacement& placement, int first,
                               int count);

/// Writes a view tile, 3 codes a texel, row by row.
void WriteTile(const std::vector<uint8_t>& codes, int term,
               const LightFieldModel::TilePosition& tile, LightFieldModel& model);

/// Writes the mean view of a triangle, 3 codes a sample, into its page.
void WriteMean(const std::vector<uint8_t>& codes, int triangle, LightFieldModel& model);

/// Writes the first terms of a vertex, as many as the model has of it, into the pages. `ring` lists
/// its triangles in the order of the maps' rows. Vertices write to bytes of their own: many threads
/// may write at once.
void WriteVertexTerms(std::span<const int> ring, const std::vector<TermMaps>& terms, int vertex,
                      LightFieldModel& model);

/// What WriteMean and WriteVertexTerms wrote.
std::vector<uint8_t> ReadMean(const LightFieldModel& model, int triangle);
TermMaps ReadVertexTerm(const LightFieldModel& model, std::span<const int> ring, int vertex,
                        int term);

}  // namespace lfm
