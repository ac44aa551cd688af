// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "core/options.h"
#include "core/progress.h"
#include "encode/block_compression.h"
#include "encode/light_field_source.h"
#include "encode/model.h"
#include "encode/vector_quantization.h"

namespace lfm {

/// In which blocks pages are stored.
enum class PageBlocks {
  kNone,
  kBc1,  ///< all pages in BC1: three monochrome surface maps in an RGB block, as the paper did
  kBc4,  ///< surface pages in three planes of BC4, one a corner; mean and view pages in BC1
};

/// How the maps of a finished model are made smaller (Chen 2002, Section 5).
struct MapCompressionOptions {
  double vq_ratio = 1;  ///< 1 = off
  double vq_db = 0;     ///< 0 = off; one of the two at most
  CodebookStart vq_start = CodebookStart::kSplitting;
  PageBlocks blocks = PageBlocks::kNone;
  BlockQuality block_quality = BlockQuality::kGood;
  double edge_weight = 4;
  void Declare(OptionVisitor& v) {
    v.Number({"vq-ratio",
              "Vector quantisation: triangles share surface maps and mean views, vertices share "
              "view maps, so that codebooks and indices take this many times fewer bytes than all "
              "maps in model.glb (model.lfz keeps whole maps); 1 = off.",
              "", 1, 1000},
             vq_ratio);
    v.Number({"vq-db",
              "The same, driven by distortion: the PSNR of what is lost, as estimated from each "
              "map's part in the light field; 0 = off.",
              "dB", 0, 99},
             vq_db);
    v.Enumeration({"vq-start",
                   "Where codebooks start: one code that is split, or all maps, the nearest two of "
                   "which are merged (about as good, and slower)."},
                  {"split", "pairwise"}, vq_start);
    v.Enumeration({"blocks",
                   "Store the pages in blocks that graphics cards read: bc1 (S3TC) for all, or bc4 "
                   "for surface maps (three times the bytes of bc1, less error) beside bc1."},
                  {"none", "bc1", "bc4"}, blocks);
    v.Enumeration({"block-quality", "How long the best blocks are searched."},
                  {"fast", "good", "best"}, block_quality);
    v.Number({"edge-weight",
              "How much jumps across triangle edges count beside errors when maps are shared or "
              "put in blocks: more makes seams fainter and loses more elsewhere; 0 = each side by "
              "itself.",
              "", 0, 100},
             edge_weight);
  }
  bool WantsCodebooks() const { return vq_ratio > 1 || vq_db > 0; }
  bool WantsAnything() const { return WantsCodebooks() || blocks != PageBlocks::kNone; }
};

/// Throws Error when both drives of the vector quantisation are given, or blocks are and the view
/// grid is no multiple of 4.
void CheckMapCompression(const MapCompressionOptions& options, int grid);

/// What the fit of view maps and the layout need to know besides.
struct MapCompressionLimits {
  double guessed_weight = 0.2;
  int max_texture_size = 4096;
};

/// The same model with codebooks, with pages in blocks, or both. Closed loop: mean views and
/// surface maps first; then view maps are fitted anew to what those have become (view_refit.h),
/// grouped and coded; then ranges are fitted to what the view maps have become.
///
/// How many codes each group of maps gets (one group a patch size and term, mean views and view
/// maps too), and whether its patches keep every sample, every second or every fourth, follows from
/// what that saves there (map_groups.h). What is shared or in blocks is not continuous over edges;
/// codes and blocks are chosen beside what the neighbours have (linked_codebooks.h,
/// linked_blocks.h). `model` is one from Encode, uncompressed. A ratio that one code a group does
/// not reach gives one code a group. Throws Error when both drives of the vector quantisation are
/// given, or blocks are and the view grid is no multiple of 4.
LightFieldModel CompressMaps(const LightFieldSource& source, const LightFieldModel& model,
                             const MapCompressionOptions& options,
                             const MapCompressionLimits& limits, Progress& progress);

}  // namespace lfm
