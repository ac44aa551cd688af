// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/options.h"
#include "core/progress.h"
#include "encode/light_field_source.h"
#include "encode/map_coarsening.h"
#include "encode/map_compression.h"
#include "encode/model.h"
#include "encode/pca_solver.h"
#include "encode/transport_form.h"
#include "resample/light_field.h"

namespace lfm {

/// How vertex light fields are factorised (Chen 2002, Section 4.1 and Appendix).
enum class Factorization {
  kPca,  ///< the mean view, and terms of either sign: the least error
  kNmf,  ///< nonnegative maps that hold the mean view too, as graphics cards of 2002 drew faster
};

/// How directions between and outside those of the photographs are filled.
enum class DirectionFill {
  kBlend,   ///< by blending the nearest photographs alone (Chen 2002, Section 5.2)
  kMirror,  ///< and by what the whole object shows in the same mirror direction (ReflectionModel)
};

struct EncodeOptions {
  static constexpr int kAsNeeded = -1;
  Factorization factorization = Factorization::kPca;
  DirectionFill fill = DirectionFill::kMirror;
  int mirror_lights = 3;
  int terms = kAsNeeded;  ///< everywhere; kAsNeeded: by term_gain or one of the targets
  double term_gain = 0.5;
  double tolerance = 0, target_db = 0, target_mb = 0;  ///< 0 = off; one at most
  int max_terms = 8;
  MapDetail patch_detail = MapDetail::kAsNeeded, view_detail = MapDetail::kAsNeeded;
  PcaSolver solver = PcaSolver::kFactored;
  Precision precision = Precision::kSingle;
  double guessed_weight = 0.2;
  double transport_db = 50;  ///< 0 = no transport form
  double geometry_error = 0.18;
  int max_texture_size = 4096;
  int memory_mib = 0;
  MapCompressionOptions compression = {};  ///< of the finished maps, in model.glb
  void Declare(OptionVisitor& v) {
    v.Enumeration(
        {"factorization",
         "Terms of either sign beside the mean view (pca: less error, and the first terms "
         "alone are a model), or nonnegative ones that hold it (nmf)."},
        {"pca", "nmf"}, factorization);
    v.Enumeration({"fill",
                   "How directions between and outside the photographs follow: by blending the "
                   "nearest (blend), or also by what the whole object shows in the same mirror "
                   "direction (mirror; needs WORK/calib and signed terms)."},
                  {"blend", "mirror"}, fill);
    v.Integer({"mirror-lights",
               "Of --fill mirror: how many pictures of the surroundings are mixed, for surfaces of "
               "different roughness and tint.",
               "", 1, 4},
              mirror_lights);
    v.Integer({"terms",
               "Terms K of every vertex: sharper highlights against bytes. -1: each vertex gets as "
               "many as it needs, by --term-gain or one of the targets (nonnegative ones: 3).",
               "", -1, 16},
              terms);
    v.Number(
        {"term-gain",
         "A vertex gets another term where that lowers the RMS error of its maps as much as "
         "this RMS, in 8-bit levels, would alone, and by more the more bytes the term takes there. "
         "Less: more terms.",
         "", 0, 255},
        term_gain);
    v.Number(
        {"tolerance",
         "In place of --term-gain: each vertex gets as few terms as keep the RMS error of its maps "
         "below this, in 8-bit levels; 0 = off.",
         "", 0, 255},
        tolerance);
    v.Number({"target-db",
              "In place of --term-gain: the terms that reach this PSNR against the resampled light "
              "field with the fewest bytes; 0 = off.",
              "dB", 0, 99},
             target_db);
    v.Number(
        {"target-mb",
         "In place of --term-gain: the terms that come nearest to the resampled light field with "
         "maps of this size in memory; 0 = off.",
         "MB", 0, 1e6},
        target_mb);
    v.Integer(
        {"max-terms",
         "Unless --terms says how many: the most terms that a vertex may get. Time and memory "
         "of the factorisation grow with it.",
         "", 1, 16},
        max_terms);
    v.Enumeration({"patch-detail",
                   "Where terms are chosen as needed: each triangle keeps only as many samples of "
                   "its mean view and of each term as are worth their bytes (as-needed), or all of "
                   "them (full)."},
                  {"as-needed", "full"}, patch_detail);
    v.Enumeration({"view-detail",
                   "Where terms are chosen as needed: each view map has the grid of the light "
                   "field, half or a quarter of it, as is worth its bytes (as-needed), or all the "
                   "same (full)."},
                  {"as-needed", "full"}, view_detail);
    v.Enumeration({"solver",
                   "What finds the terms: products with the factors; the paper's power iteration; "
                   "or every singular value in double precision. The last two form each vertex's "
                   "matrix and take hundreds of times as long."},
                  {"factored", "paper", "dense"}, solver);
    v.Enumeration({"precision",
                   "Of the factored solver: single is within 1e-6 of the best terms, double within "
                   "1e-10, in some 20 times the time. Maps have 8 bits either way."},
                  {"single", "double"}, precision);
    v.Number({"guessed-weight",
              "How much directions outside the hull of the photographs count in the fit, against "
              "1 for those inside.",
              "", 0.01, 1},
             guessed_weight);
    v.Number({"transport-db",
              "Accuracy of the transport form, model.lfz, against the model (every sample of it, "
              "whatever --patch-detail and --view-detail): bytes against PSNR (20 to 90); 0 = do "
              "not write it.",
              "dB", 0, 90},
             transport_db);
    v.Number({"geometry-error",
              "How far the transport form may move a vertex, in samples of the surface maps "
              "(1.5 pixels of a photograph at most).",
              "", 0.001, 10},
             geometry_error);
    v.Integer({"max-texture-size", "Largest side of a texture page.", "texels", 256, 16384},
              max_texture_size);
    v.Integer({"encode-memory-mib",
               "Most memory to take: where encoding may need more (about four times the 8-bit maps "
               "of all terms that a vertex may get, and 2 kB a triangle) it is refused before it "
               "begins. 0 = what the machine has.",
               "MiB", 0, 1 << 24},
              memory_mib);
    compression.Declare(v);
  }
};

/// Whether these options let maps keep fewer samples: patch_detail or view_detail is kAsNeeded, and
/// terms are chosen by gain or by one of the targets, plain maps of them.
bool ChoosesDetail(const EncodeOptions& options);

struct EncodeResult {
  LightFieldModel model;
  double terms_mean = 0;
  int terms_max = 0;
  /// Vertices with 0, 1, ... terms: what this scene required.
  std::vector<int> vertices_by_terms;
  int64_t maps_bytes = 0;
  double compression_ratio = 0;  ///< dense_bytes / maps_bytes
  /// The quantised model against the resampled light field, 1.0 being the peak: over all vertex
  /// matrices F^v (hat-weighted, all grid directions alike, guessed ones too),
  /// mean squared error weighted by their number of entries (rows of triangles that some
  /// photograph saw, times 3N); -10 log10 of it, 99 at most.
  /// With coarser patches, codebooks or blocks: of the model with these, its mean view's errors
  /// included.
  /// This is the paper's "weighted average over all light field matrices" (Section 6.2); being
  /// hat-weighted it reads higher than the PSNR of a picture.
  double matrix_psnr_db = 0;
  double matrix_psnr_mean_only_db = 0;  ///< the same for the mean view alone
  /// The same with the first 0, 1, ... of each vertex's terms: what the last ones brought. The
  /// numbers between the ends mean nothing for nonnegative terms, which do not add up one by one.
  std::vector<double> matrix_psnr_by_terms_db;
  std::vector<double> singular_value_share;  ///< mean share of energy, a term of the model each
  int unseen_triangles = 0;                  ///< filled from their neighbours
  /// The model in transport form, every sample of its maps, without codebooks; may be empty.
  EncodedTransport transport;
  int64_t model_bytes = 0;  ///< of model.glb; known once it is saved
};

/// Fills directions (a source without eyes, and nonnegative terms, by blending alone), then
/// factorises every vertex light field (its hat-weighted blocks, in factored form), quantises in
/// closed loop, chooses how many terms each vertex gets and how many samples each triangle keeps of
/// them (map_selection.h; the latter where terms are chosen by gain or target, and maps are neither
/// shared nor in blocks), and tiles the maps, in memory and in transport form. Two runs give the
/// same bytes, whatever the number of threads. Memory: the 8-bit maps of all terms that
/// may be chosen, the model (up to three times while resolutions are chosen for a target), and one
/// vertex ring a thread: EncodeBytes (memory_need.h), refused where options.memory_mib is less.
///
/// A vertex without view-dependent energy gets no terms; terms = 0 gives the mean view alone.
/// A tolerance or PSNR that max_terms do not reach gives all of them, and a note. Triangles that
/// nobody saw are filled from their neighbours. Throws Error when nobody saw anything, the light
/// field is inconsistent, several targets are given, or the mean view alone is larger than
/// target_mb.
EncodeResult Encode(const LightField& light_field, const EncodeOptions& options,
                    Progress& progress);
/// The same from data in memory.
EncodeResult Encode(const LightFieldSource& source, const EncodeOptions& options,
                    Progress& progress);

}  // namespace lfm
