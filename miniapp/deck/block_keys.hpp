// The keys of a deck's block, each named once together with the field of a struct that it sets. The
// same list makes the schema, in which the values of a default-constructed struct are the defaults,
// and reads a deck into the struct.
//
//   void dampingKeys(BlockKeys& keys, Config& config) {
//     keys.add("mass", config.mass_damping, "alpha of the force -alpha m v").in("1/s").atLeast(0);
//   }
#pragma once

#include "io/deck/deck.hpp"
#include "miniapp/deck/words.hpp"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace brickwall::miniapp {

class BlockKeys {
public:
  // For the schema: no deck.
  BlockKeys() = default;
  // For reading this instance of a block: "wall", "load.pressure[0]".
  BlockKeys(const io::Deck& deck, std::string instance)
      : _deck(&deck), _instance(std::move(instance)) {}

  // One key. A key that the deck does not give, or whose value is faulty, leaves its field as it
  // is. Texts, optional and infinite values have no default.
  template <class Field>
  io::KeyRule& add(const std::string& name, Field& field, const std::string& help) {
    _rules.push_back(ruleOf(name, field, help));
    if (_deck && _deck->isGood(_instance, name))
      read(name, field);
    return _rules.back();
  }

  std::vector<io::KeyRule> rules() const { return _rules; }

private:
  using Components = std::array<bool, 3>; // a list of those of "x", "y", "z" that are true
  template <class Entry, std::size_t size>
  using Array = std::array<Entry, size>;

  static io::KeyRule ruleOf(const std::string& name, bool value, const std::string& help);
  static io::KeyRule ruleOf(const std::string& name, std::int64_t value, const std::string& help);
  static io::KeyRule ruleOf(const std::string& name, double value, const std::string& help);
  static io::KeyRule ruleOf(const std::string& name, const std::string& value,
                            const std::string& help);
  static io::KeyRule ruleOf(const std::string& name, const Components& value,
                            const std::string& help);
  template <class Entry, std::size_t size>
  static io::KeyRule ruleOf(const std::string& name, const Array<Entry, size>& value,
                            const std::string& help) {
    std::string defaults;
    for (const Entry& entry : value)
      defaults += (defaults.empty() ? "[" : ", ") + ruleOf("", entry, "").fallback;
    return ruleOf(name, Entry(), help).list(size).byDefault(defaults + "]");
  }
  template <class Value>
  static io::KeyRule ruleOf(const std::string& name, const std::optional<Value>&,
                            const std::string& help) {
    return ruleOf(name, Value(), help).optional();
  }
  template <class Enum, class = std::enable_if_t<std::is_enum<Enum>::value>>
  static io::KeyRule ruleOf(const std::string& name, Enum value, const std::string& help) {
    io::KeyRule rule = io::word(name, {}, help).byDefault(nameOf(value));
    for (const Word<Enum>& entry : wordsOf(value)) {
      rule.words.push_back(entry.word);
      if (entry.former)
        rule.former_words.emplace_back(entry.former, entry.word);
    }
    return rule;
  }
  template <class Enum>
  static io::KeyRule ruleOf(const std::string& name, const std::vector<Enum>& values,
                            const std::string& help) {
    std::string defaults;
    for (const Enum value : values)
      defaults += (defaults.empty() ? "[\"" : ", \"") + std::string(nameOf(value)) + '"';
    return ruleOf(name, Enum(), help).list(io::KeyRule::any_length).byDefault(defaults + "]");
  }

  void read(const std::string& name, bool& field) const;
  void read(const std::string& name, std::int64_t& field) const;
  void read(const std::string& name, double& field) const;
  void read(const std::string& name, std::string& field) const;
  void read(const std::string& name, Components& field) const;
  template <std::size_t size>
  void read(const std::string& name, Array<double, size>& field) const {
    const std::vector<double> values = _deck->reals(_instance, name);
    std::copy(values.begin(), values.end(), field.begin());
  }
  template <std::size_t size>
  void read(const std::string& name, Array<std::int64_t, size>& field) const {
    const std::vector<std::int64_t> values = _deck->integers(_instance, name);
    std::copy(values.begin(), values.end(), field.begin());
  }
  template <class Value>
  void read(const std::string& name, std::optional<Value>& field) const {
    read(name, field.emplace());
  }
  template <class Enum, class = std::enable_if_t<std::is_enum<Enum>::value>>
  void read(const std::string& name, Enum& field) const {
    field = enumeratorOf(_deck->text(_instance, name), field);
  }
  template <class Enum>
  void read(const std::string& name, std::vector<Enum>& field) const {
    field.clear();
    for (const std::string& word : _deck->texts(_instance, name))
      field.push_back(enumeratorOf(word, Enum()));
  }

  const io::Deck* _deck = nullptr;
  std::string _instance;
  std::vector<io::KeyRule> _rules;
};

// `block` with the keys that `keysOf` lists.
template <class Block>
io::BlockRule withKeys(io::BlockRule block, void (*keysOf)(BlockKeys&, Block&)) {
  BlockKeys keys;
  Block defaults;
  keysOf(keys, defaults);
  block.keys = keys.rules();
  return block;
}

// Reads an instance of a block into `block`.
template <class Block>
void readBlock(const io::Deck& deck, const std::string& instance,
               void (*keysOf)(BlockKeys&, Block&), Block& block) {
  BlockKeys keys(deck, instance);
  keysOf(keys, block);
}

} // namespace brickwall::miniapp
