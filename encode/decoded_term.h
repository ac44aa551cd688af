// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "encode/factored_operator.h"
#include "encode/map_quantization.h"

namespace lfm {

/// A term of a vertex as the decoder sees it, and F^T u, from which errors follow without F.
struct DecodedTerm {
  std::vector<float> surface;   ///< M; 0 in triangles that nobody saw: no data to fit
  std::vector<float> view;      ///< 3N, channels outer
  std::vector<double> product;  ///< F^T surface, 3N
};

/// Sum of products, in float64.
double DotProduct(const std::vector<float>& a, const std::vector<float>& b);

/// F^T u.
std::vector<double> ProductWith(const VertexOperator& f, const std::vector<float>& surface);

/// The values of a view map of any grid in the `directions` = grid^2 of the light field, 3 q +
/// channel.
std::vector<float> DecodedView(const TermMaps& maps, int directions);

/// Sets `surface` and `product`, or `view`, from quantised maps.
void DecodeSurface(const VertexOperator& f, const TermMaps& maps, DecodedTerm& decoded);
void DecodeView(const VertexOperator& f, const TermMaps& maps, DecodedTerm& decoded);

/// What the last term changes in ||F - U V^T||^2.
double ErrorChange(const std::vector<DecodedTerm>& terms);

/// Triangles that nobody saw go on as the rest of the ring does on average: c times the hat
/// function, c being the least squares ratio of map to hat where it was measured. Their edges stay
/// shared.
void ContinueIntoUnseen(const VertexOperator& f, const SharedSamples& shared,
                        std::vector<float>& u);

/// Samples an edge of each patch of the ring.
std::vector<int> EdgeSamples(const VertexOperator& f);

}  // namespace lfm
