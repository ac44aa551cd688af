// SPDX-License-Identifier: BSD-3-Clause
#include <string>

#include "core/command_line.h"
#include "core/error.h"
#include "sample_data/studio.h"

namespace {

struct Output {
  std::string folder;
  void Declare(lfm::OptionVisitor& v) {
    v.Text({"out", "Folder of the capture; made when it does not exist."}, folder);
  }
};

}  // namespace

int main(int argc, char** argv) {
  lfm::CommandLine command("lfm-capture",
                           "Renders a synthetic capture: photographs and structured-light scans of "
                           "an object on the printed platform, and the truth about them.",
                           "lfm-capture --out demo/capture");
  Output output;
  lfm::StudioOptions options;
  command.Options(lfm::AnyOptions(output));
  command.Options(lfm::AnyOptions(options), "Studio");
  return command.Run(argc, argv, [&](lfm::Progress& progress) {
    if (output.folder.empty()) {
      throw lfm::Error("no folder to write to; give --out DIR");
    }
    lfm::MakeCapture(options, output.folder, progress);
  });
}
