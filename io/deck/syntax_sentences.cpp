// The messages of toml11 3.7.1 are those of a parser: they name tokens, and few say what to write.
#include "io/deck/syntax_sentences.hpp"

namespace brickwall::io {
namespace {

constexpr const char* one_value = "a number, true, false, a text in quotation marks or a list in "
                                  "brackets";
constexpr const char* a_line =
    "key = value, [table] or [[table]]; names have letters, digits, _ and -";

// A message of toml11 by its begin, with what a deck's reader is told instead; an empty `found`
// keeps the message.
struct Sentence {
  const char* begin;
  const char* found;
  const char* expected;
};
constexpr Sentence sentences[] = {
    {"the next token is not a valid string",
     "a text that does not end on its line, or has a control character or an unknown escape",
     "a quotation mark at its end, and \\\\ for a backslash"},
    {"the next token is not a valid literal string", "a text that does not end on its line",
     "a quotation mark ' at its end"},
    {"the next token is not a valid multiline string",
     "a text that does not end, or has a control "
     "character or an unknown escape",
     "three quotation marks at its end, and \\\\ for a backslash"},
    {"the next token is not a valid multiline literal string", "a text that does not end",
     "three quotation marks ''' at its end"},
    {"an invalid key", "an invalid key", a_line},
    {"invalid key", "an invalid key", a_line},
    {"dotted key contains invalid key", "an invalid key", a_line},
    {"empty key", "no key before =", "key = value"},
    {"bad integer", "", "digits only, such as 1000 or 1_000"},
    {"bad float", "", "digits before and after the point, such as 2.0 or 2.0e9"},
    {"bad format: unknown value appeared", "a value of no known kind", one_value},
    {"the next token is not a boolean", "a word without quotation marks",
     "true, false or a text in quotation marks"},
    {"missing value after key-value separator", "no value after =", one_value},
    {"missing key-value separator", "no = after a key", "key = value"},
    {"missing array separator", "no comma after a value in a list", "a comma or ]"},
    {"value having invalid format appeared in an array", "no value at this place of a list",
     "a value after each comma"},
    {"newline required after [table.key]", "more after the name of a table",
     "[table] or [[table]] on a line of its own"},
    {"table (", "", "each table once"},
    {"array of table", "", "each table once, or always in double brackets"},
    {"value (", "", "each key once"},
};

// The found text of "expected newline, but got '3'", empty without one.
std::string textInsteadOfLineEnd(const std::string& remark) {
  const std::string begin = "expected newline, but got ";
  return remark.compare(0, begin.size(), begin) == 0 ? remark.substr(begin.size()) : "";
}

} // namespace

TomlSyntaxError syntaxErrorInWords(const Position& at, std::string found, std::string remark) {
  while (!remark.empty() && remark.back() == '.')
    remark.pop_back();
  if (const std::string more = textInsteadOfLineEnd(remark); !more.empty())
    return TomlSyntaxError(at, more + " after a value", "the end of the line, or # and a comment");
  std::string expected = "valid TOML (https://toml.io)";
  for (const Sentence& sentence : sentences)
    if (found.rfind(sentence.begin, 0) == 0 || remark.rfind(sentence.begin, 0) == 0) {
      if (*sentence.found != '\0')
        return TomlSyntaxError(at, sentence.found, sentence.expected);
      expected = sentence.expected;
      break;
    }
  for (const std::string begin : {"expected ", "should be "})
    if (remark.rfind(begin, 0) == 0)
      return TomlSyntaxError(at, found, remark.substr(begin.size()));
  if (!remark.empty() && remark != "here")
    found += " (" + remark + ")";
  return TomlSyntaxError(at, found, expected);
}

} // namespace brickwall::io
