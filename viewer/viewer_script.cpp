// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/viewer_script.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <span>
#include <string_view>
#include <utility>

#include "core/atomic_file.h"
#include "core/error.h"

namespace lfm {
namespace {

using Kind = ScriptStep::Kind;

constexpr size_t kMostBytes = 16000000;
constexpr int kMostLines = 100000;
constexpr double kMostNumber = 16384;
constexpr std::string_view kBlanks = " \t\r";

// What the words behind a step's name are.
enum class TextForm { kNone, kKey, kButton, kModifier, kFile, kPng, kJson, kSetting };
enum class NumberForm { kAny, kWhole, kCount };

struct StepForm {
  Kind kind;
  std::string_view name, usage;
  TextForm text = TextForm::kNone;
  int numbers = 0;
  NumberForm number = NumberForm::kAny;
};

constexpr StepForm kSteps[] = {
    {Kind::kKey, "key", "key NAME", TextForm::kKey},
    {Kind::kMove, "move", "move X Y", TextForm::kNone, 2},
    {Kind::kPress, "press", "press BUTTON", TextForm::kButton},
    {Kind::kRelease, "release", "release BUTTON", TextForm::kButton},
    {Kind::kDrag, "drag", "drag BUTTON X0 Y0 X1 Y1", TextForm::kButton, 4},
    {Kind::kClick, "click", "click BUTTON X Y", TextForm::kButton, 2},
    {Kind::kDoubleClick, "double-click", "double-click BUTTON X Y", TextForm::kButton, 2},
    {Kind::kScroll, "scroll", "scroll RIGHT FORWARDS", TextForm::kNone, 2},
    {Kind::kHold, "hold", "hold MODIFIER", TextForm::kModifier},
    {Kind::kLetGo, "let-go", "let-go MODIFIER", TextForm::kModifier},
    {Kind::kDrop, "drop", "drop FILE", TextForm::kFile},
    {Kind::kResize, "resize", "resize WIDTH HEIGHT", TextForm::kNone, 2, NumberForm::kWhole},
    {Kind::kWait, "wait", "wait FRAMES", TextForm::kNone, 1, NumberForm::kCount},
    {Kind::kLoaded, "loaded", "loaded"},
    {Kind::kScreenshot, "screenshot", "screenshot FILE.png", TextForm::kPng},
    {Kind::kWindowshot, "windowshot", "windowshot FILE.png", TextForm::kPng},
    {Kind::kSet, "set", "set NAME VALUE", TextForm::kSetting},
    {Kind::kState, "state", "state FILE.json", TextForm::kJson},
    {Kind::kQuit, "quit", "quit"},
};

// Besides letters and digits.
constexpr std::string_view kKeys[] = {
    "F1",     "F2",    "F3",    "F4",  "F5",     "F6",    "F7",   "F8",   "F9",      "F10",
    "F11",    "F12",   "home",  "end", "left",   "right", "up",   "down", "page-up", "page-down",
    "escape", "space", "enter", "tab", "delete", "minus", "plus", "[",    "]"};
constexpr std::string_view kButtons[] = {"left", "right", "middle"};
constexpr std::string_view kModifiers[] = {"shift", "ctrl", "alt"};

bool IsOneOf(std::string_view word, std::span<const std::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

// A key as it is in a step's text; empty when there is none of that name.
std::string KeyNamed(std::string_view word) {
  if (IsOneOf(word, kKeys)) return std::string(word);
  if (word.size() != 1) return "";
  const char c = word[0];
  if (c >= 'a' && c <= 'z') return {static_cast<char>(c - 'a' + 'A')};
  return (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ? std::string{c} : "";
}

// Not longer than a message bears.
std::string Quoted(std::string_view word) {
  constexpr size_t kMostQuoted = 40;
  const bool cut = word.size() > kMostQuoted;
  return "'" + std::string(word.substr(0, kMostQuoted)) + (cut ? "...'" : "'");
}

// A line without its comment and the blanks at its end, taken apart from the left.
class Words {
 public:
  explicit Words(std::string_view line) : rest_(line) {
    for (size_t at = rest_.find('#'); at != std::string_view::npos; at = rest_.find('#', at + 1)) {
      if (at > 0 && kBlanks.find(rest_[at - 1]) == std::string_view::npos) continue;
      rest_ = rest_.substr(0, at);
      break;
    }
    rest_ = rest_.substr(0, rest_.find_last_not_of(kBlanks) + 1);
    SkipBlanks();
  }
  bool empty() const { return rest_.empty(); }
  std::string_view Take() {
    const std::string_view word = rest_.substr(0, rest_.find_first_of(kBlanks));
    rest_.remove_prefix(word.size());
    SkipBlanks();
    return word;
  }
  std::string_view TakeRest() { return std::exchange(rest_, {}); }

 private:
  void SkipBlanks() {
    rest_.remove_prefix(std::min(rest_.find_first_not_of(kBlanks), rest_.size()));
  }
  std::string_view rest_;
};

class StepParser {
 public:
  StepParser(const std::string& file, int line) : file_(file), line_(line) {}

  ScriptStep Parse(Words words) const {
    const StepForm& form = FormOf(words.Take());
    ScriptStep step{form.kind, TextOf(form, words), {}, line_};
    for (int i = 0; i < form.numbers; ++i) {
      if (words.empty()) FailAsUsed(form, "a number is missing");
      step.numbers.push_back(Number(form, words.Take()));
    }
    if (!words.empty()) FailAsUsed(form, Quoted(words.TakeRest()) + " is too much");
    return step;
  }

  [[noreturn]] void Fail(const std::string& problem) const {
    throw Error(file_ + ": line " + std::to_string(line_) + ": " + problem);
  }

 private:
  [[noreturn]] void FailAsUsed(const StepForm& form, const std::string& problem) const {
    Fail(problem + "; write " + std::string(form.usage));
  }

  const StepForm& FormOf(std::string_view name) const {
    std::string known;
    for (const StepForm& form : kSteps) {
      if (form.name == name) return form;
      known += (known.empty() ? "" : ", ") + std::string(form.name);
    }
    Fail("there is no step " + Quoted(name) + ", but " + known);
  }

  std::string TextOf(const StepForm& form, Words& words) const {
    if (form.text == TextForm::kNone) return "";
    if (words.empty()) FailAsUsed(form, "a word is missing");
    switch (form.text) {
      case TextForm::kKey: {
        const std::string_view word = words.Take();
        std::string key = KeyNamed(word);
        if (key.empty()) {
          Fail("there is no key " + Quoted(word) + ", but letters, digits" + Listed(kKeys));
        }
        return key;
      }
      case TextForm::kButton:
        return OneOf(kButtons, form, words.Take());
      case TextForm::kModifier:
        return OneOf(kModifiers, form, words.Take());
      case TextForm::kPng:
        return File(form, ".png", words.TakeRest());
      case TextForm::kJson:
        return File(form, ".json", words.TakeRest());
      case TextForm::kSetting: {
        const std::string_view name = words.Take();
        if (words.empty()) FailAsUsed(form, "the setting's value is missing");
        return std::string(name) + " " + std::string(words.TakeRest());
      }
      default:
        return File(form, "", words.TakeRest());
    }
  }

  static std::string Listed(std::span<const std::string_view> words) {
    std::string listed;
    for (const std::string_view word : words) listed += ", " + std::string(word);
    return listed;
  }

  std::string OneOf(std::span<const std::string_view> words, const StepForm& form,
                    std::string_view word) const {
    if (!IsOneOf(word, words)) {
      FailAsUsed(form, Quoted(word) + " is none of" + Listed(words).substr(1));
    }
    return std::string(word);
  }

  std::string File(const StepForm& form, std::string_view ending, std::string_view name) const {
    if (name.find('\0') != std::string_view::npos) {
      FailAsUsed(form, Quoted(name.substr(0, name.find('\0'))) + " is followed by a zero byte");
    }
    if (std::filesystem::path(name).extension() != ending && !ending.empty()) {
      FailAsUsed(form, Quoted(name) + " does not end in " + std::string(ending));
    }
    return std::string(name);
  }

  double Number(const StepForm& form, std::string_view word) const {
    double number = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc() || end != word.data() + word.size() ||
        !(std::abs(number) <= kMostNumber)) {
      FailAsUsed(form, Quoted(word) + " is not a number from -16384 to 16384");
    }
    const double least = form.number == NumberForm::kCount ? 1 : 0;
    if (form.number != NumberForm::kAny && !(number >= least && number == std::floor(number))) {
      FailAsUsed(form, Quoted(word) + " is not a whole number from " +
                           std::to_string(static_cast<int>(least)) + " to 16384");
    }
    return number;
  }

  const std::string& file_;
  int line_;
};

}  // namespace

std::vector<ScriptStep> ReadViewerScript(const std::filesystem::path& file) {
  const std::string content = ReadFile(file, kMostBytes), name = file.string();
  std::vector<ScriptStep> steps;
  std::string_view left = content;
  int line = 0;
  while (!left.empty()) {
    const std::string_view text = left.substr(0, left.find('\n'));
    left.remove_prefix(std::min(text.size() + 1, left.size()));
    const StepParser parser(name, ++line);
    if (line > kMostLines) parser.Fail("a script has 100000 lines at most; make two of it");
    const Words words(text);
    if (words.empty()) continue;
    if (!steps.empty() && steps.back().kind == Kind::kQuit) {
      parser.Fail("quit is the last step; remove what follows it");
    }
    steps.push_back(parser.Parse(words));
  }
  if (steps.empty() || steps.back().kind != Kind::kQuit) {
    steps.push_back({Kind::kQuit, "", {}, line + 1});
  }
  return steps;
}

}  // namespace lfm
