// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "encode/vertex_factorization.h"

namespace lfm {

/// Factorises one vertex light field into nonnegative maps and quantises them (Chen 2002, Appendix:
/// NMF). `f` is the matrix with nothing taken out (BuildVertexOperator with a mean of zero), so the
/// terms hold the mean view too; `mean_only_error` is the squared error of the mean view alone, for
/// VertexTerms::squared_errors. Surface maps are made equal on shared samples and quantised,
/// one after the other (ComputeNmf: strongest first); rounding is taken back by those that follow.
/// Then all view maps are fitted to them once more, together and nonnegative, and quantised in the
/// same order, each time fitting those that are left: rounding does not add up over the terms.
///
/// Other than FactorizeVertex not progressive: fewer terms are another factorisation, and the first
/// of K terms alone show less light. The solvers are ComputeNmf (kFactored) and the appendix's
/// multiplicative updates on the formed matrix (kPaper); throws Error for kDense. No energy: no
/// terms.
VertexTerms FactorizeNonnegative(const VertexOperator& f, const SharedSamples& shared,
                                 double mean_only_error, const FactorizationOptions& options);

}  // namespace lfm
