// SPDX-License-Identifier: BSD-3-Clause
#include "encode/option_effects.h"

#include "core/error.h"

namespace lfm {

void RequireEffect(const EncodeOptions& options,
                   const std::function<bool(const std::string& name)>& given) {
  const bool nonnegative = options.factorization == Factorization::kNmf;
  const bool terms_are_fixed = options.terms != EncodeOptions::kAsNeeded;
  const bool target = options.tolerance > 0 || options.target_db > 0 || options.target_mb > 0;
  const struct {
    const char* name;
    bool idle;
    const char* reason;
  } rules[] = {
      {"term-gain", nonnegative, "with --factorization nmf, where --terms says how many"},
      {"term-gain", terms_are_fixed, "with --terms, which says how many"},
      {"term-gain", target, "with --tolerance, --target-db or --target-mb, which stand in for it"},
      {"max-terms", nonnegative, "with --factorization nmf, where --terms says how many"},
      {"max-terms", terms_are_fixed, "with --terms, which says how many"},
      {"patch-detail", options.patch_detail == MapDetail::kAsNeeded && !ChoosesDetail(options),
       "as as-needed with --terms, --tolerance, nmf, codebooks or blocks, which keep all samples "
       "or choose their own"},
      {"view-detail", options.view_detail == MapDetail::kAsNeeded && !ChoosesDetail(options),
       "as as-needed with --terms, --tolerance, nmf, codebooks or blocks, which keep all samples "
       "or choose their own"},
      {"fill", nonnegative && options.fill == DirectionFill::kMirror,
       "as mirror with --factorization nmf, which cannot take its signed changes"},
      {"mirror-lights", nonnegative, "with --factorization nmf, which blends alone"},
      {"mirror-lights", options.fill == DirectionFill::kBlend, "with --fill blend"},
      {"geometry-error", !(options.transport_db > 0), "with --transport-db 0"},
      {"vq-start", !options.compression.WantsCodebooks(), "without --vq-ratio or --vq-db"},
      {"edge-weight", !options.compression.WantsAnything(),
       "without --vq-ratio, --vq-db or --blocks"},
      {"block-quality", options.compression.blocks == PageBlocks::kNone, "without --blocks"},
  };
  for (const auto& rule : rules) {
    if (rule.idle && given(rule.name)) {
      throw Error(std::string("--") + rule.name + " has no effect " + rule.reason +
                  "; leave one out");
    }
  }
}

}  // namespace lfm
