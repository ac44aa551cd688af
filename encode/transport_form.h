// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "encode/model.h"
#include "encode/model_order.h"

namespace lfm {

/// The form of a model for disks and networks (docs/formats.md): transformed, quantised and entropy
/// coded maps in the order of what they bring. It is decoded to the run-time form when it is
/// loaded.

struct TransportOptions {
  /// PSNR of the light field that comes back, against that of the model; 20 to 90.
  double psnr_db = 52;
  /// How far a vertex may move, in samples of the surface maps (median spacing); 0.001 to 10. Maps
  /// have two to four samples for every three pixels of a photograph: a quarter of a pixel at most.
  double geometry_error = 0.18;
};

/// The stream, and how much of it is geometry and mean view.
struct EncodedTransport {
  std::string bytes;
  int64_t geometry_bytes = 0, mean_bytes = 0;
  MeshOrder order;  ///< of the vertices and triangles that come back, in those of the model
};

/// Whether the model is not too large for the form: 4 million vertices, 8 million triangles, 2^28
/// texels in all, coordinates below 1e12 mm.
bool FitsTransportForm(const LightFieldModel& model);

/// Each term u v^T of a vertex is coded as sigma u / |u| and sigma v / |v|, so that an error in
/// either weighs the same in their product: cosine coefficients of both (triangles, square of
/// directions, opponent colours) are rounded to multiples of one step for the whole model (a dead
/// zone saves 2 % of the bytes and costs 0.1 dB of held-out PSNR). The step follows from `psnr_db`,
/// judged over all vertices' matrices as in EncodeResult::matrix_psnr_db; the mean view is coded to
/// the same PSNR. What rounds to zero goes. The mesh is rounded to a lattice and coded in an order
/// of its own (mesh_coder.h): ReorderModel with the inverse of `order` puts a decoded model in the
/// order of the first.
///
/// Deterministic, whatever the number of threads. Throws Error for a model that is not consistent,
/// has codebooks or patches of their own resolution, or does not fit, or a PSNR out of range.
EncodedTransport EncodeTransport(const LightFieldModel& model, const TransportOptions& options);

/// A model, and how many parts of its stream were not there.
struct DecodedModel {
  LightFieldModel model;
  int parts_missing = 0;
};

/// The run-time form: maps made continuous, quantised to 8 bits and tiled as Encode does. Any
/// prefix that holds the mean view is a model. Throws Error, beginning with `name`, for what is
/// damaged, hostile, or ends before that.
DecodedModel DecodeTransport(std::string_view bytes, const std::string& name);

/// What to tell the user of a file with parts missing.
std::string CutOffNote(const std::filesystem::path& file, const DecodedModel& decoded);

/// Reads a model in any form: a .glb, the transport form, or MPEG-4 AFX (.wrl), told apart by their
/// first bytes. Throws Error as ReadGlb, DecodeTransport and ReadAfx do.
DecodedModel ReadModel(const std::filesystem::path& file);

}  // namespace lfm
