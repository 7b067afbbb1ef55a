#include "miniapp/deck/block_keys.hpp"

namespace brickwall::miniapp {

namespace {
constexpr const char* component_names[] = {"x", "y", "z"};
}

io::KeyRule BlockKeys::ruleOf(const std::string& name, bool value, const std::string& help) {
  return io::boolean(name, help).byDefault(value ? "true" : "false");
}
io::KeyRule BlockKeys::ruleOf(const std::string& name, std::int64_t value,
                              const std::string& help) {
  return io::integer(name, help).byDefault(std::to_string(value));
}
io::KeyRule BlockKeys::ruleOf(const std::string& name, double value, const std::string& help) {
  return io::real(name, "", help).byDefault(value);
}
io::KeyRule BlockKeys::ruleOf(const std::string& name, const std::string&,
                              const std::string& help) {
  return io::text(name, help);
}
io::KeyRule BlockKeys::ruleOf(const std::string& name, const Components& value,
                              const std::string& help) {
  std::string defaults;
  for (int d = 0; d < 3; ++d)
    if (value[d])
      defaults += (defaults.empty() ? "\"" : ", \"") + std::string(component_names[d]) + "\"";
  return io::word(name, {component_names[0], component_names[1], component_names[2]}, help)
      .list(io::KeyRule::any_length)
      .byDefault("[" + defaults + "]");
}

void BlockKeys::read(const std::string& name, bool& field) const {
  field = _deck->boolean(_instance, name);
}
void BlockKeys::read(const std::string& name, std::int64_t& field) const {
  field = _deck->integer(_instance, name);
}
void BlockKeys::read(const std::string& name, double& field) const {
  field = _deck->real(_instance, name);
}
void BlockKeys::read(const std::string& name, std::string& field) const {
  field = _deck->text(_instance, name);
}
void BlockKeys::read(const std::string& name, Components& field) const {
  field = {false, false, false};
  for (const std::string& word : _deck->texts(_instance, name))
    field[static_cast<std::size_t>(word[0] - 'x')] = true;
}

} // namespace brickwall::miniapp
