// SPDX-License-Identifier: BSD-3-Clause
// Redraws the table and figures of Yamada 2009 for a captured or rendered reflectance field.
#include <cstdio>
#include <filesystem>
#include <string>

#include "bench/yamada_figures.h"
#include "core/command_line.h"
#include "fields/field_capture.h"
#include "fields/field_reading.h"

namespace {

struct BenchOptions {
  bool quick = false;
  std::string out = "yamada";
  lfm::FieldReadOptions read;
  void Declare(lfm::OptionVisitor& v) {
    v.Flag({"quick", "Two configurations instead of the paper's nine."}, quick);
    v.Text({"out", "Folder for charts and pictures."}, out);
    read.Declare(v);
  }
};

}  // namespace

int main(int argc, char** argv) {
  lfm::CommandLine command("lfm-bench-yamada",
                           "Prints Table 1 of Yamada 2009 and redraws Figures 4 to 6 for a field.",
                           "lfm-bench-yamada plant --field-reduce 2 --out figures");
  std::string path;
  command.Positional("CAPTURE", "capture folder or .lp file", path);
  BenchOptions options;
  command.Options(lfm::AnyOptions(options));
  return command.Run(argc, argv, [&](lfm::Progress& progress) {
    const lfm::Capture capture = lfm::OpenFieldCapture(path, {}, progress);
    lfm::YamadaField data;
    data.field = lfm::ReadReflectanceField(capture, options.read, progress).train;
    data.kinds = lfm::SplitByKind(data.field);
    data.out = options.out;
    std::filesystem::create_directories(data.out);
    std::printf(
        "%s: %d x %d pixels, %d lights; rows of the object %zu, unoccluded %zu, specular "
        "%zu\n\n",
        data.field.name.c_str(), data.field.width, data.field.height, data.field.functions.columns,
        data.kinds.object.size(), data.kinds.unoccluded.size(), data.kinds.specular.size());
    std::vector<lfm::YamadaConfiguration> table = {{32, 4}, {128, 4}}, few = {{64, 4}};
    if (!options.quick) {
      table = {{32, 4},  {32, 8},  {32, 16}, {64, 4},  {64, 8},
               {64, 16}, {128, 4}, {128, 8}, {128, 16}};
      few = {{32, 4}, {64, 4}, {64, 8}, {64, 16}};
    }
    lfm::PrintTable1(data, table, nullptr, progress);
    lfm::PrintFigure5(data, few, progress);
    lfm::PrintFigure6(data, progress);
    lfm::PrintHaar(data, progress);
  });
}
