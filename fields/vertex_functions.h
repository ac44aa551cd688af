// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "core/options.h"
#include "core/progress.h"
#include "fields/field.h"
#include "resample/light_field.h"

namespace lfm {

/// What the numbers of a vertex's function are.
enum class RadianceSpace {
  kLinear,
  kSrgbCoded,  ///< as the light field stores them: what the factorisations of encode/ see
};

/// What the columns of a vertex's function are.
enum class VertexDirections {
  kFrameGrid,  ///< the entries of the light field's view grid, in the vertex's own frame
  kWorldCube,  ///< the texels of a cube map (core/cube_map.h), in the world's (Mahajan 2007, 5)
};

struct VertexFunctionOptions {
  RadianceSpace space = RadianceSpace::kLinear;
  VertexDirections directions = VertexDirections::kFrameGrid;
  int cube_resolution = 16;  ///< texels a side of a face, kWorldCube
  void Declare(OptionVisitor& v) {
    v.Enumeration({"vertex-space", "Numbers of vertex functions."}, {"linear", "srgb"}, space);
    v.Enumeration({"vertex-directions", "Columns of vertex functions."},
                  {"frame-grid", "world-cube"}, directions);
    v.Integer({"vertex-cube", "Texels a side of a face of the world's cube map.", "", 1, 256},
              cube_resolution);
  }
};

/// A light field's vertices as functions over directions towards the eye.
struct VertexFunctions {
  Field field;  ///< of kind kViews, 3 channels, a point a vertex
  /// points x columns: 1 where the direction lies inside the convex hull of what the photographs
  /// around the vertex saw, 0 where the value is guessed (or 0).
  std::vector<uint8_t> seen;
  std::vector<int64_t> unseen_vertices;  ///< ascending; no photograph shows a triangle at them
};

/// The radiance that leaves each vertex of a resampled surface light field.
///
/// F_v[q] = mean over triangles t at v of sum_k w_t[q][k] P_t[corner][view_t[q][k]]: the sample at
/// the vertex under each triangle's own view weights (F = P W, resample/light_field.h), averaged
/// over the triangles that saw direction q, or over all that anyone saw where none did. kWorldCube
/// interpolates F_v bilinearly on the view grid, as viewers do; directions below the vertex's
/// horizon (with a skirt: below the skirt's border) are zero and unseen, and an entry is seen when
/// every grid entry that it comes from is. kLinear takes the sRGB curve off the result.
///
/// Takes 13 bytes x vertices x columns, padded; parallel over vertices, deterministic. Extremes: a
/// vertex of no triangle, or of triangles that nobody saw, has zero rows, is listed, and is 0 in
/// the field's mask; imputed values exceed 1. Throws Error when an option or the matrix's size is
/// out of range, or the machine has not the memory.
VertexFunctions ReadVertexFunctions(const LightField& light_field,
                                    const VertexFunctionOptions& options, Progress& progress);

}  // namespace lfm
