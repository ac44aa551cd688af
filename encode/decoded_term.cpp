// SPDX-License-Identifier: BSD-3-Clause
#include "encode/decoded_term.h"

#include <cmath>

#include "encode/view_resolution.h"

namespace lfm {
namespace {

constexpr int kProductWidth = 8;  // the narrowest that the kernels multiply

int GridSide(size_t directions) {
  return static_cast<int>(std::lround(std::sqrt(static_cast<double>(directions))));
}

}  // namespace

double DotProduct(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += static_cast<double>(a[i]) * b[i];
  return sum;
}

std::vector<double> ProductWith(const VertexOperator& f, const std::vector<float>& surface) {
  std::vector<float> columns(static_cast<size_t>(f.rows) * kProductWidth, 0.f);
  for (int row = 0; row < f.rows; ++row) columns[row * kProductWidth] = surface[row];
  std::vector<float> products(static_cast<size_t>(f.cols()) * kProductWidth);
  MultiplyTransposed(f, columns.data(), kProductWidth, products.data());
  std::vector<double> product(f.cols());
  for (int col = 0; col < f.cols(); ++col) product[col] = products[col * kProductWidth];
  return product;
}

void DecodeSurface(const VertexOperator& f, const TermMaps& maps, DecodedTerm& decoded) {
  decoded.surface.assign(maps.surface_codes.size(), 0.f);
  for (const RingBlock& block : f.blocks) {
    if (block.views == 0) continue;
    for (int row = block.first_row; row < block.first_row + block.samples; ++row) {
      decoded.surface[row] = DecodeValue(maps.surface_range, maps.surface_codes[row]);
    }
  }
  decoded.product = ProductWith(f, decoded.surface);
}

std::vector<float> DecodedView(const TermMaps& maps, int directions) {
  std::vector<float> view;
  view.reserve(maps.view_codes.size());
  for (const uint8_t code : maps.view_codes) view.push_back(DecodeValue(maps.view_range, code));
  if (view.size() == size_t{3} * directions) return view;
  return ResamplerBetween(GridSide(view.size() / 3), GridSide(directions))(view);
}

void DecodeView(const VertexOperator& f, const TermMaps& maps, DecodedTerm& decoded) {
  const std::vector<float> view = DecodedView(maps, f.directions);
  decoded.view.resize(f.cols());
  for (int col = 0; col < f.cols(); ++col) {
    decoded.view[col] = view[3 * (col % f.directions) + col / f.directions];
  }
}

double ErrorChange(const std::vector<DecodedTerm>& terms) {
  const DecodedTerm& last = terms.back();
  double change = 0;
  for (size_t col = 0; col < last.view.size(); ++col) change -= last.product[col] * last.view[col];
  for (const DecodedTerm& other : terms) {
    const double overlap =
        DotProduct(last.surface, other.surface) * DotProduct(last.view, other.view);
    change += &other == &last ? overlap / 2 : overlap;
  }
  return 2 * change;
}

void ContinueIntoUnseen(const VertexOperator& f, const SharedSamples& shared,
                        std::vector<float>& u) {
  double product = 0, norm = 0;
  std::vector<PatchValues> patches;
  for (const RingBlock& block : f.blocks) {
    patches.push_back({u.data() + block.first_row, block.views > 0});
    if (block.views == 0) continue;
    for (int s = 0; s < block.samples; ++s) {
      product += static_cast<double>(u[block.first_row + s]) * block.hat[s];
      norm += static_cast<double>(block.hat[s]) * block.hat[s];
    }
  }
  bool any_unseen = false;
  for (const RingBlock& block : f.blocks) {
    if (block.views > 0) continue;
    any_unseen = true;
    for (int s = 0; s < block.samples; ++s) {
      u[block.first_row + s] = static_cast<float>(product / norm) * block.hat[s];
    }
  }
  if (any_unseen) MakeContinuous(shared, 1, patches);
}

std::vector<int> EdgeSamples(const VertexOperator& f) {
  std::vector<int> sizes;
  for (const RingBlock& block : f.blocks) sizes.push_back(block.edge_samples);
  return sizes;
}

}  // namespace lfm
