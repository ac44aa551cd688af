// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <string>

#include "core/command_line.h"
#include "core/error.h"
#include "encode/option_effects.h"
#include "fields/heldout_lights.h"
#include "pipeline/pipeline.h"
#include "pipeline/workspace.h"

namespace {

struct Arguments {
  std::string action, capture;
  lfm::PipelineOptions options;
};

void Declare(lfm::CommandLine& line, Arguments& arguments) {
  line.Positional("ACTION", "What to do: run.", arguments.action);
  line.Positional("CAPTURE",
                  "Capture folder, with capture.json; of pictures under many lights also "
                  "an .lp file, or a folder in DiLiGenT's layout.",
                  arguments.capture);
  line.Options(lfm::AnyOptions(arguments.options));
  line.Options(lfm::AnyOptions(arguments.options.calib), "Cameras (calib)");
  line.Options(lfm::AnyOptions(arguments.options.scan), "Scans (scan)");
  line.Options(lfm::AnyOptions(arguments.options.mesh), "Surface (mesh)");
  line.Options(lfm::AnyOptions(arguments.options.resample), "Resampling (resample)");
  line.Options(lfm::AnyOptions(arguments.options.encode), "Light field maps (encode)");
  line.Options(lfm::AnyOptions(arguments.options.light), "Captures that vary in light");
}

lfm::CommandLine MakeCommandLine() {
  return lfm::CommandLine(
      "lfm-pipeline",
      "Runs every stage from a capture to a light field and a report of how good it is. Stages "
      "whose inputs and options are unchanged are skipped.",
      "lfm-pipeline run demo/capture --out demo/work --effort best");
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  {
    // The effort decides the defaults of all other options, so it is read before them.
    Arguments peeked;
    lfm::CommandLine line = MakeCommandLine();
    Declare(line, peeked);
    line.Peek(argc, argv);
    arguments.options = lfm::PresetOptions(peeked.options.effort);
  }
  lfm::CommandLine line = MakeCommandLine();
  Declare(line, arguments);
  return line.Run(argc, argv, [&](lfm::Progress& progress) {
    if (arguments.action != "run") {
      throw lfm::Error("unknown action '" + arguments.action + "'; use: lfm-pipeline run CAPTURE");
    }
    lfm::RequireEffect(arguments.options.encode,
                       [&line](const std::string& name) { return line.Given(name); });
    const lfm::PipelineSummary summary =
        lfm::RunPipeline(arguments.capture, arguments.options, progress);
    const lfm::Workspace workspace{arguments.options.out};
    const bool lights = lfm::VariesInLight(arguments.capture);
    for (const auto& [stage, record] : summary.stages) {
      if (stage == "evaluate" && record.figures.contains("heldout_psnr_mean_only_db")) {
        std::printf("held-out PSNR %.2f dB (mean view alone %.2f dB)\n",
                    record.figures.at("heldout_psnr_db").get<double>(),
                    record.figures.at("heldout_psnr_mean_only_db").get<double>());
      }
      if (stage == "evaluate" && lights)
        std::fputs(lfm::LightFiguresToTable(record.figures).c_str(), stdout);
      if (stage == "evaluate" && record.figures.contains("note")) {
        std::printf("%s\n", record.figures.at("note").get<std::string>().c_str());
      }
      if (stage == "encode") {
        std::printf("model   %s\n",
                    (lights ? workspace.RelightableFile() : workspace.ModelFile()).c_str());
      }
      if (stage == "report") {
        std::printf("report  %s\n", (workspace.Stage("report") / "index.html").c_str());
      }
    }
  });
}
