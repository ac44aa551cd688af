// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/options.h"
#include "core/progress.h"
#include "encode/model.h"
#include "resample/light_field.h"

namespace lfm {

struct EncodeOptions {
  int terms = 3;
  int max_texture_size = 4096;
  void Declare(OptionVisitor& v) {
    v.Integer({"terms", "Terms K a vertex: sharper highlights against bytes.", "", 0, 16}, terms);
    v.Integer({"max-texture-size", "Largest side of a texture page.", "texels", 256, 16384},
              max_texture_size);
  }
};

struct EncodeResult {
  LightFieldModel model;
  double terms_mean = 0;
  int terms_max = 0;
  int64_t maps_bytes = 0;
  double compression_ratio = 0;              ///< dense_bytes / maps_bytes
  double matrix_psnr_db = 0;                 ///< quantised model against the resampled light field
  std::vector<double> singular_value_share;  ///< mean share of energy, term by term
};

/// Factorises every vertex light field (PCA of the hat-weighted blocks, in factored form),
/// quantises in closed loop, and tiles the maps.
EncodeResult Encode(const LightField& light_field, const EncodeOptions& options,
                    Progress& progress);

}  // namespace lfm
