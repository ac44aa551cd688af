// SPDX-License-Identifier: BSD-3-Clause
// Our form of the tables and figures of Chen 2002 (Tables 1 and 2, Figures 8, 9 and 11 to 14) for
// objects of the studio: lfm-bench-paper OUT estimate|truth NAME... Captures lie in
// OUT/NAME/capture; bench/paper_tables makes them. Tables go to standard output as Markdown,
// figures to OUT/figures.
#include <cmath>
#include <cstdio>
#include <string>

#include "bench/paper_object.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/image.h"
#include "core/line_chart.h"
#include "encode/encode.h"

namespace lfm {
namespace {

namespace fs = std::filesystem;

constexpr double kSamplesATriangle = 314;  // of the paper
constexpr int kTerms = 3, kMostTerms = 6;

// Section 5 and Figure 5 of the paper: directions on a disc, partly visible triangles discarded.
ResampleOptions PaperResampling() {
  return {.view_grid = 32,
          .direction_map = DirectionMap::kOrthographic,
          .max_grazing_deg = 80,
          .min_data_share = 1,
          .hull_margin = 0,
          .max_hidden_share = 0,
          .photo_gains = PhotoGainUse::kOff};
}

EncodeResult EncodeWith(const PaperLightField& field, EncodeOptions options, Progress& progress) {
  options.transport_db = 0;
  options.fill = DirectionFill::kBlend;
  return Encode(field.light_field, options, progress);
}

EncodeResult EncodeOurs(const PaperLightField& field, EncodeOptions options, Progress& progress) {
  options.transport_db = 0;
  return Encode(SourceFromLightField(field.light_field, field.eyes), options, progress);
}

double RmsInLevels(double psnr_db) { return 255 * std::pow(10.0, -psnr_db / 20); }

double Megabytes(int64_t bytes) { return static_cast<double>(bytes) * 1e-6; }

// What the maps of the first terms take: pages of later ones lie behind.
int64_t BytesOfFirstTerms(const LightFieldModel& model, int terms) {
  LightFieldModel first = model;
  first.terms = terms;
  first.surface_pages.resize(terms);
  first.view_pages.resize(terms);
  first.surface_placements.resize(terms);
  first.view_codes.resize(terms);
  first.surface_ranges.resize(terms * model.mesh.vertices.size());
  first.view_ranges.resize(terms * model.mesh.vertices.size());
  return first.MapsBytes();
}

// Section 5: what Table 2 counts.
struct Form {
  const char* name;
  MapCompressionOptions compression;
};
// With which the paper's 800 : 1 and, in blocks that are four to six times smaller, its 5000 : 1
// are reached.
constexpr double kVqRatio = 8, kVqRatioWithBlocks = 14;
const Form kForms[] = {
    {"maps", {}},
    {"VQ", {.vq_ratio = kVqRatio}},
    {"BC1", {.blocks = PageBlocks::kBc1}},
    {"BC4 surface maps, BC1", {.blocks = PageBlocks::kBc4}},
    {"VQ and BC1", {.vq_ratio = kVqRatioWithBlocks, .blocks = PageBlocks::kBc1}},
};

// What is collected over all objects.
struct Charts {
  LineChart quality_by_terms{"PSNR of the resampled matrices (Figure 9)", "terms", "dB", {}, {}};
  LineChart triangle_size{
      "Triangle size, bust (Figure 8)", "compression ratio", "dB", ChartScale::kLogarithmic, {}};
};

class PaperTables {
 public:
  PaperTables(fs::path out, GeometryOf geometry)
      : out_(std::move(out)), kind_(geometry == GeometryOf::kTruth ? "truth" : "estimate") {}

  void Add(const PaperObject& object) {
    const PaperLightField field =
        ResamplePaperObject(object, kSamplesATriangle, PaperResampling(), progress_);
    AddTable1(object, field);
    const EncodeResult three = EncodeWith(field, {.terms = kTerms}, progress_);
    AddTable2(object, field);
    AddQualityByTerms(object, field);
    AddOurs(object, three);
    DrawRenderings(object, field);
    if (object.name == "bust") AddTriangleSizes(object);
  }

  void Finish() {
    fs::create_directories(out_ / "figures");
    WriteFileAtomically(out_ / "figures" / ("figure_9_" + kind_ + ".svg"),
                        ChartToSvg(charts_.quality_by_terms));
    if (!charts_.triangle_size.curves.empty()) {
      WriteFileAtomically(out_ / "figures" / ("figure_8_" + kind_ + ".svg"),
                          ChartToSvg(charts_.triangle_size));
    }
    std::printf(
        "\n**Table 1** (geometry: %s)\n\n%s\n**Table 2**\n\n%s\n**Figure 9, in numbers** "
        "(PSNR in dB / RMS in levels)\n\n%s\n**The paper's pipeline and ours at equal "
        "bytes in memory**\n\n%s\n%s",
        kind_.c_str(), table_1_.c_str(), table_2_.c_str(), quality_.c_str(), ours_.c_str(),
        figure_11_.c_str());
  }

 private:
  template <typename... Values>
  static void Append(std::string& text, const char* format, Values... values) {
    char line[400];
    std::snprintf(line, sizeof line, format, values...);
    text += line;
    std::fputs(line, stderr);
  }

  void AddTable1(const PaperObject& object, const PaperLightField& field) {
    if (table_1_.empty()) {
      table_1_ =
          "| model | triangles | photographs | samples a triangle | raw, normalised | resampled "
          "|\n|---|---|---|---|---|---|\n";
    }
    Append(table_1_, "| %s | %d | %zu | %.0f | %.0f MB | %.2f GB |\n", object.name.c_str(),
           field.light_field.triangle_count(), field.light_field.photo_ids().size(),
           field.figures.samples_per_triangle, Megabytes(field.raw_bytes),
           Megabytes(field.light_field.DenseBytes()) / 1000);
  }

  void AddTable2(const PaperObject& object, const PaperLightField& field) {
    if (table_2_.empty()) {
      table_2_ =
          "| model | form of 3 terms | bytes | dense : 1 | matrix | held out |\n"
          "|---|---|---|---|---|---|\n";
    }
    for (const Form& form : kForms) {
      const EncodeResult result =
          EncodeWith(field, {.terms = kTerms, .compression = form.compression}, progress_);
      Append(table_2_, "| %s | %s | %.3f MB | %.0f | %.2f dB | %.2f dB |\n", object.name.c_str(),
             form.name, Megabytes(result.maps_bytes), result.compression_ratio,
             result.matrix_psnr_db, ScorePaperModel(object, result.model, progress_).psnr_db);
    }
  }

  void AddQualityByTerms(const PaperObject& object, const PaperLightField& field) {
    if (quality_.empty()) {
      quality_ =
          "| model | way | 1 | 2 | 3 | 4 | 5 | 6 terms |\n|---|---|---|---|---|---|---|---|\n";
    }
    const EncodeResult pca = EncodeWith(field, {.terms = kMostTerms}, progress_);
    ChartCurve curve{object.name + ", PCA", {}, {}};
    for (size_t k = 1; k < pca.matrix_psnr_by_terms_db.size(); ++k) {
      curve.x.push_back(static_cast<double>(k));
      curve.y.push_back(pca.matrix_psnr_by_terms_db[k]);
    }
    AddCurve(object.name, "PCA", curve);
    ChartCurve nmf{object.name + ", NMF", {}, {}};
    for (int k = 1; k <= kMostTerms; ++k) {
      nmf.x.push_back(k);
      nmf.y.push_back(
          EncodeWith(field, {.factorization = Factorization::kNmf, .terms = k}, progress_)
              .matrix_psnr_db);
    }
    AddCurve(object.name, "NMF", nmf);
  }

  void AddCurve(const std::string& object, const char* way, const ChartCurve& curve) {
    Append(quality_, "| %s | %s |", object.c_str(), way);
    for (const double db : curve.y) Append(quality_, " %.2f / %.2f |", db, RmsInLevels(db));
    Append(quality_, "\n");
    charts_.quality_by_terms.curves.push_back(curve);
  }

  // Our mesh, directions and terms as needed, in as many bytes of maps as the paper's pipeline.
  void AddOurs(const PaperObject& object, const EncodeResult& paper) {
    if (ours_.empty()) {
      ours_ =
          "| model | pipeline | bytes | matrix | held out | mean view alone |\n"
          "|---|---|---|---|---|---|\n";
    }
    AddPipeline(object, "paper: disc, 3 terms, whole triangles", paper);
    const double megabytes = Megabytes(paper.maps_bytes);
    for (const double samples : {kSamplesATriangle, kSamplesATriangle / 2}) {
      const PaperLightField field = ResamplePaperObject(object, samples, {}, progress_);
      char name[80];
      std::snprintf(name, sizeof name, "ours, %.0f samples a triangle",
                    field.figures.samples_per_triangle);
      AddPipeline(object, name, EncodeOurs(field, {.target_mb = megabytes}, progress_));
    }
  }

  void AddPipeline(const PaperObject& object, const char* name, const EncodeResult& result) {
    const HeldoutScores scores = ScorePaperModel(object, result.model, progress_);
    Append(ours_, "| %s | %s | %.1f MB | %.2f dB | %.2f dB | %.2f dB |\n", object.name.c_str(),
           name, Megabytes(result.maps_bytes), result.matrix_psnr_db, scores.psnr_db,
           scores.psnr_mean_only_db);
  }

  void AddTriangleSizes(const PaperObject& object) {
    for (const double samples : {78.0, 157.0, 314.0, 628.0, 1256.0}) {
      const PaperLightField field =
          ResamplePaperObject(object, samples, PaperResampling(), progress_);
      const EncodeResult result = EncodeWith(field, {.terms = kMostTerms}, progress_);
      char name[40];
      std::snprintf(name, sizeof name, "%.0f samples", field.figures.samples_per_triangle);
      ChartCurve curve{name, {}, {}};
      for (int k = 1; k <= result.terms_max; ++k) {
        curve.x.push_back(static_cast<double>(field.light_field.DenseBytes()) /
                          static_cast<double>(BytesOfFirstTerms(result.model, k)));
        curve.y.push_back(result.matrix_psnr_by_terms_db[k]);
      }
      charts_.triangle_size.curves.push_back(curve);
    }
  }

  // Figures 11 to 14: a photograph, and models beside it.
  void DrawRenderings(const PaperObject& object, const PaperLightField& field) {
    std::vector<EncodeOptions> ways;
    if (object.name == "turtle") {  // 11: one term, the smallest form
      ways = {{.terms = 1, .compression = kForms[std::size(kForms) - 1].compression}};
    } else if (object.name == "dancer") {  // 12: PCA and NMF
      ways = {{.terms = kTerms}, {.factorization = Factorization::kNmf, .terms = kTerms}};
    } else if (object.name == "star") {  // 14: more and more terms
      for (const int terms : {1, 2, 3, 4}) ways.push_back({.terms = terms});
    } else {  // 13: forms of the maps
      for (const Form& form : kForms) {
        ways.push_back({.terms = kTerms, .compression = form.compression});
      }
    }
    std::vector<LightFieldModel> models;
    for (const EncodeOptions& way : ways) {
      models.push_back(EncodeWith(field, way, progress_).model);
    }
    std::vector<const LightFieldModel*> row;
    for (const LightFieldModel& model : models) row.push_back(&model);
    WriteImage(PhotographBeside(object, 0, row),
               out_ / "figures" / (object.name + "_" + kind_ + ".png"));
    if (object.name != "turtle") return;
    const HeldoutScores scores = ScorePaperModel(object, models.front(), progress_);
    char line[200];
    std::snprintf(
        line, sizeof line,
        "turtle, one term, VQ and BC1 (Figure 11): %.0f KB, %.0f : 1, APE %.2f, %.2f dB\n",
        1000 * Megabytes(models.front().MapsBytes()),
        static_cast<double>(field.light_field.DenseBytes()) /
            static_cast<double>(models.front().MapsBytes()),
        scores.ape, scores.psnr_db);
    figure_11_ += line;
  }

  fs::path out_;
  std::string kind_;
  Charts charts_;
  std::string table_1_, table_2_, quality_, ours_, figure_11_;
  Progress& progress_ = SilentProgress();
};

int Run(int argc, char** argv) {
  const std::string kind = argc > 2 ? argv[2] : "";
  if (argc < 4 || (kind != "estimate" && kind != "truth")) {
    std::fprintf(stderr, "usage: lfm-bench-paper OUT estimate|truth NAME...\n");
    return 2;
  }
  const GeometryOf geometry = kind == "truth" ? GeometryOf::kTruth : GeometryOf::kEstimate;
  PaperTables tables(argv[1], geometry);
  for (int i = 3; i < argc; ++i) {
    tables.Add(OpenPaperObject(fs::path(argv[1]) / argv[i], geometry, SilentProgress()));
  }
  tables.Finish();
  return 0;
}

}  // namespace
}  // namespace lfm

int main(int argc, char** argv) {
  try {
    return lfm::Run(argc, argv);
  } catch (const lfm::Error& error) {
    std::fprintf(stderr, "lfm-bench-paper: error: %s\n", error.what());
    return 2;
  }
}
