#include "miniapp/deck/deck_reference.hpp"

#include "io/deck/deck_spelling.hpp"

#include <cmath>
#include <regex>
#include <sstream>

namespace brickwall::miniapp {
namespace {

constexpr const char* introduction =
    "# Keys of a deck\n\n"
    "<!-- Written by: build/miniapp/brickwall --keys markdown > miniapp/deck/reference.md -->\n\n"
    "A deck is a [TOML](https://toml.io) file. Blocks may stand in any order; a block in double "
    "brackets may be given several times.\n"
    "Units are SI, or any [consistent set](#units); angles are in radians. Text and words stand in "
    "quotation "
    "marks.\n"
    "`brickwall check DECK` reports all faults of a deck together, `--set BLOCK.KEY=VALUE` "
    "replaces "
    "a value, and\n"
    "`<deck>.resolved.toml` in the output folder holds the values of all keys of a run.\n"
    "\n## Units\n\n"
    "The program converts nothing: with the units of one row for all values, results are in that "
    "row too. Wall clock times stay in seconds. The key `units` names the row for labels.\n"
    "Mind the density, of which water has 1000 kg/m3 = 1e-9 t/mm3 = 1e-6 kg/mm3 = 1 g/cm3, and "
    "gravity. `brickwall check` compares wave speeds with them.\n\n"
    "| length | mass | time | force | stress | energy | velocity | steel (nu = 0.3): density | "
    "Young's modulus | wave speed | gravity |\n"
    "|---|---|---|---|---|---|---|---|---|---|---|\n"
    "| m | kg | s | N | Pa | J | m/s | 7850 | 2.1e11 | 6001 | 9.81 |\n"
    "| mm | t | s | N | MPa | mJ | mm/s | 7.85e-9 | 2.1e5 | 6.001e6 | 9810 |\n"
    "| mm | kg | ms | kN | GPa | J | m/s | 7.85e-6 | 210 | 6001 | 9.81e-3 |\n"
    "| cm | g | us | 1e7 N | Mbar (100 GPa) | 1e5 J | 1e4 m/s | 7.85 | 2.1 | 0.6001 | "
    "9.81e-10 |\n";

std::string typeOf(const io::KeyRule& key) {
  const bool is_list = key.length != io::KeyRule::scalar;
  const std::string count =
      key.length > 0 ? std::to_string(key.length) + " " : std::string(is_list ? "list of " : "");
  switch (key.type) {
  case io::ValueType::boolean:
    return "`true` or `false`";
  case io::ValueType::integer:
    return count + (is_list ? "integers" : "integer");
  case io::ValueType::real:
    return count + (is_list ? "numbers" : "number");
  case io::ValueType::word:
    return count + (is_list ? "words" : "word");
  case io::ValueType::text:
    break;
  }
  return count + (is_list ? "texts" : "text");
}

std::string rangeOf(const io::KeyRule& key) {
  std::ostringstream out;
  out.precision(15);
  for (const std::string& word : key.words)
    out << (out.tellp() > 0 ? ", `" : "`") << word << '`';
  if (std::isfinite(key.lower))
    out << (key.lower_is_open ? "> " : ">= ") << key.lower;
  if (std::isfinite(key.upper))
    out << (std::isfinite(key.lower) ? ", " : "") << (key.upper_is_open ? "< " : "<= ")
        << key.upper;
  return out.str();
}

// A text that is no markup of tables or HTML.
std::string escaped(const std::string& text) {
  return std::regex_replace(text, std::regex("\\||<(?=[a-z])"), "\\$&");
}

} // namespace

std::string deckReference(const io::Schema& schema) {
  std::ostringstream out;
  out << introduction;
  for (const io::BlockRule& block : schema) {
    out << "\n## "
        << (block.kind == io::BlockKind::top ? "Before the first block"
                                             : "`" + io::headerOf(block) + "`")
        << "\n\n";
    if (!block.help.empty())
      out << escaped(block.help) << (block.required ? "; must be given.\n\n" : ".\n\n");
    out << "| key | type | unit | default | range | meaning |\n|---|---|---|---|---|---|\n";
    for (const io::KeyRule& key : block.keys)
      out << "| `" << key.name << "` | " << typeOf(key) << " | " << key.unit << " | "
          << (key.required           ? "required"
              : key.fallback.empty() ? "none"
                                     : "`" + key.fallback + "`")
          << " | " << rangeOf(key) << " | " << escaped(key.help) << " |\n";
  }
  return out.str();
}

} // namespace brickwall::miniapp
