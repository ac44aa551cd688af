// SPDX-License-Identifier: BSD-3-Clause
#include "core/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <new>
#include <string_view>

#include "core/config_file.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/printable_text.h"

namespace lfm {
namespace {

constexpr int kExitOk = 0, kExitFailure = 1, kExitInput = 2, kExitInterrupted = 130;

void HandleSignal(int) { RequestInterrupt(); }

void InstallSignalHandlers() {
  struct sigaction action {};
  action.sa_handler = HandleSignal;
  sigemptyset(&action.sa_mask);
  // A second Ctrl-C ends the process at once, as people expect.
  action.sa_flags = SA_RESETHAND | SA_RESTART;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);  // NOLINT(cert-err33-c)
  std::signal(SIGXFSZ, SIG_IGN);  // NOLINT(cert-err33-c): a full quota is an error like others
}

std::string HelpText(const OptionInfo& info) {
  std::string help = info.help;
  if (*info.unit != '\0') help += " [" + std::string(info.unit) + "]";
  return help;
}

// Declares every option to CLI11, which also reads the config file. Ranges are checked afterwards
// by ValidateOptions, so that both ways give the same message.
class CliDeclarer : public OptionVisitor {
 public:
  CliDeclarer(CLI::App& app, std::string group) : app_(app), group_(std::move(group)) {}
  void Number(const OptionInfo& info, double& value) override { AddNumber(info, value); }
  void Integer(const OptionInfo& info, int& value) override { AddNumber(info, value); }
  void Flag(const OptionInfo& info, bool& value) override {
    Finish(app_.add_flag("--" + std::string(info.name) + ",!--no-" + info.name, value,
                         HelpText(info)));
  }
  void Text(const OptionInfo& info, std::string& value) override { Finish(Add(info, value)); }
  void Choice(const OptionInfo& info, const std::vector<std::string>& names, int& value) override {
    ChoiceBySetter(info, names, value, [&value](int index) { value = index; });
  }
  void ChoiceBySetter(const OptionInfo& info, const std::vector<std::string>& names, int current,
                      const std::function<void(int)>& set) override {
    const auto choose = [names, set](const std::string& name) {
      set(static_cast<int>(std::find(names.begin(), names.end(), name) - names.begin()));
    };
    Finish(
        app_.add_option_function<std::string>("--" + std::string(info.name), choose, HelpText(info))
            ->check(CLI::IsMember(names))
            ->default_str(names.at(current)));
  }

 private:
  template <typename T>
  CLI::Option* Add(const OptionInfo& info, T& value) {
    return app_.add_option("--" + std::string(info.name), value, HelpText(info))
        ->capture_default_str();
  }
  template <typename T>
  void AddNumber(const OptionInfo& info, T& value) {
    Finish(Add(info, value)->check(RequireNumber, ""));
  }
  // CLI11 reads nothing at all as zero.
  static std::string RequireNumber(const std::string& text) {
    return text.empty() ? "it needs a number" : "";
  }
  void Finish(CLI::Option* option) {
    if (!group_.empty()) option->group(group_);
  }
  CLI::App& app_;
  std::string group_;
};

// One line that a terminal can show, whatever a library put into its message.
std::string OneLine(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  return PrintableText(text);
}

// What was typed is echoed so far.
std::string Shortened(const std::string& text) {
  constexpr size_t kLongest = 400;
  return text.size() <= kLongest ? text : text.substr(0, kLongest) + " ...";
}

}  // namespace

struct CommandLine::State {
  State(const std::string& command, const std::string& description, const std::string& example)
      : name(command), app(description, command) {
    app.set_version_flag("--version", command + " " LFM_VERSION);
    app.footer("Example:\n  " + example);
    app.add_flag("-q,--quiet", quiet, "Say nothing but errors.");
    app.add_flag("-v,--verbose", verbose, "Say why things are done, too.");
    app.add_option("--threads", threads, "Use this many threads; 0 means all.")
        ->check(CLI::Range(0, 4096))
        ->capture_default_str();
    app.set_config("--config", "", "Read options from this TOML file.");
    app.config_formatter(config_reader);
    app.allow_config_extras(CLI::config_extras_mode::error);
  }
  std::string name;
  CLI::App app;
  std::shared_ptr<ConfigFileReader> config_reader = std::make_shared<ConfigFileReader>();
  std::vector<AnyOptions> options;
  bool quiet = false, verbose = false;
  int threads = 0;

  int Report(const std::string& what, int status) const {
    std::fprintf(stderr, "%s: error: %s\n", name.c_str(), OneLine(what).c_str());
    return status;
  }
  std::string ConfigFile() const;
  int Parse(int argc, char** argv, bool& go_on);
  int RunBody(const std::function<void(Progress&)>& body) const;
};

CommandLine::CommandLine(std::string name, std::string description, std::string example)
    : state_(std::make_unique<State>(name, description, example)) {}
CommandLine::~CommandLine() = default;

void CommandLine::Positional(const std::string& name, const std::string& help, std::string& value) {
  state_->app.add_option(name, value, help)->required();
}

void CommandLine::Options(AnyOptions options, const std::string& group) {
  CliDeclarer declarer(state_->app, group);
  options.Declare(declarer);
  state_->options.push_back(options);
}

void CommandLine::Peek(int argc, char** argv) {
  try {
    state_->app.parse(argc, argv);
  } catch (const CLI::ParseError&) {
    // Run parses again and reports.
  }
}

std::string CommandLine::State::ConfigFile() const {
  const CLI::Option* config = app.get_config_ptr();
  return config->count() > 0 ? config->as<std::string>() : "";
}

bool CommandLine::Given(const std::string& option) const {
  return state_->app.get_option("--" + option)->count() > 0;
}

int CommandLine::State::Parse(int argc, char** argv, bool& go_on) {
  go_on = false;
  const auto in_file = [&](const std::string& what) {
    return config_reader->Caused(what, argc, argv) ? ConfigFile() + ": " + what : what;
  };
  try {
    app.parse(argc, argv);
    for (const AnyOptions& o : options) ValidateOptions(o);
    go_on = true;
    return kExitOk;
  } catch (const CLI::ConfigError& e) {
    std::string what = e.what();
    constexpr std::string_view kUnknown = "INI was not able to parse ";
    if (what.starts_with(kUnknown)) what = "unknown option " + what.substr(kUnknown.size());
    return Report(ConfigFile() + ": " + Shortened(what) + " (see " + name + " --help)", kExitInput);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);
    return Report(in_file(Shortened(e.what())) + " (see " + name + " --help)", kExitInput);
  } catch (const Error& e) {
    return Report(in_file(e.what()), kExitInput);
  }
}

int CommandLine::State::RunBody(const std::function<void(Progress&)>& body) const {
  try {
    const std::unique_ptr<Progress> progress = MakeConsoleProgress(
        quiet ? Verbosity::kQuiet : (verbose ? Verbosity::kVerbose : Verbosity::kNormal));
    progress->Detail(name + " " LFM_VERSION ", at most " + std::to_string(ThreadCount()) +
                     " threads");
    body(*progress);
    return kExitOk;
  } catch (const Interrupted&) {
    std::fprintf(stderr, "%s: interrupted; run the same command again to go on\n", name.c_str());
    return kExitInterrupted;
  } catch (const Error& e) {
    return Report(e.what(), e.kind() == ErrorKind::kInput ? kExitInput : kExitFailure);
  } catch (const std::bad_alloc&) {
    return Report("out of memory; use fewer or smaller pictures, or a machine with more memory",
                  kExitFailure);
  } catch (const std::exception& e) {
    return Report(std::string("internal error: ") + e.what(), kExitFailure);
  }
}

int CommandLine::Run(int argc, char** argv, const std::function<void(Progress&)>& body) {
  bool go_on = false;
  const int status = state_->Parse(argc, argv, go_on);
  if (!go_on) return status;
  SetThreadCount(state_->threads);
  InstallSignalHandlers();
  return state_->RunBody(body);
}

}  // namespace lfm
