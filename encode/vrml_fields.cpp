// SPDX-License-Identifier: BSD-3-Clause
#include "encode/vrml_fields.h"

#include <cmath>
#include <limits>

#include "encode/vrml_tokens.h"

namespace lfm::vrml {
namespace {

bool HasNumbersAlone(const Value& value) {
  return value.strings.empty() && value.nodes.empty() && !value.flag;
}
bool HasNodesAlone(const Value& value) {
  return value.strings.empty() && value.numbers.empty() && !value.flag;
}

}  // namespace

void Fields::Fail(int line, const std::string& problem) const { FailAt(name_, line, problem); }

std::vector<int> Fields::Integers(const Node& node, std::string_view field,
                                  const std::vector<int>& fallback) const {
  const Value* value = node.Find(field);
  if (value == nullptr) return fallback;
  Require(HasNumbersAlone(*value), value->line, std::string(field) + " holds other than numbers");
  std::vector<int> integers;
  integers.reserve(value->numbers.size());
  for (const double number : value->numbers) {
    Require(number == std::floor(number) && std::abs(number) <= std::numeric_limits<int>::max(),
            value->line, std::string(field) + " holds a number that is no integer of 32 bits");
    integers.push_back(static_cast<int>(number));
  }
  return integers;
}

std::vector<float> Fields::Floats(const Node& node, std::string_view field, int dimensions,
                                  const std::vector<float>& fallback) const {
  const Value* value = node.Find(field);
  if (value == nullptr) return fallback;
  Require(HasNumbersAlone(*value), value->line, std::string(field) + " holds other than numbers");
  Require(value->numbers.size() % static_cast<size_t>(dimensions) == 0, value->line,
          std::string(field) + " does not hold " + std::to_string(dimensions) + " numbers each");
  std::vector<float> floats;
  floats.reserve(value->numbers.size());
  for (const double number : value->numbers) {
    Require(std::abs(number) <= std::numeric_limits<float>::max(), value->line,
            std::string(field) + " holds a number that is too large");
    floats.push_back(static_cast<float>(number));
  }
  return floats;
}

bool Fields::Flag(const Node& node, std::string_view field, bool fallback) const {
  const Value* value = node.Find(field);
  if (value == nullptr) return fallback;
  Require(value->flag.has_value(), value->line, std::string(field) + " is not TRUE or FALSE");
  return *value->flag;
}

std::string Fields::String(const Node& node, std::string_view field,
                           const std::string& fallback) const {
  const Value* value = node.Find(field);
  if (value == nullptr) return fallback;
  Require(!value->strings.empty(), value->line, std::string(field) + " holds no string");
  return value->strings.front();
}

int Fields::Child(const Node& node, std::string_view field, std::string_view type) const {
  const Value* value = node.Find(field);
  if (value == nullptr) return -1;
  Require(HasNodesAlone(*value) && value->nodes.size() <= 1, value->line,
          std::string(field) + " is not one node");
  if (value->nodes.empty()) return -1;
  const int child = value->nodes.front();
  Require(type.empty() || At(child).type == type, At(child).line,
          std::string(field) + " is not a node " + std::string(type));
  return child;
}

std::vector<int> Fields::Children(const Node& node, std::string_view field,
                                  std::string_view type) const {
  const Value* value = node.Find(field);
  if (value == nullptr) return {};
  Require(HasNodesAlone(*value), value->line, std::string(field) + " holds other than nodes");
  for (const int child : value->nodes) {
    Require(At(child).type == type, At(child).line,
            std::string(field) + " holds other than nodes " + std::string(type));
  }
  return value->nodes;
}

}  // namespace lfm::vrml
