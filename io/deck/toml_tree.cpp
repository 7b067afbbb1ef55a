// Reads TOML with toml11 3.7.1 and corrects its known faults: numbers that are too large are
// recognised by their spelling, members keep the order of the text, and syntax errors become a
// position and two short sentences (`syntax_sentences.cpp`).
#include "io/deck/toml_tree.hpp"

#include "io/deck/syntax_sentences.hpp"

#include <toml.hpp>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <sstream>

namespace brickwall::io {
namespace {

// value.location() counts the lines before the value twice; a deck may have many values.
const toml::detail::region& regionOf(const toml::value& value) {
  return dynamic_cast<const toml::detail::region&>(*toml::detail::get_region(value));
}

// The places of all ends of lines in a text.
using LineEnds = std::vector<std::ptrdiff_t>;

Position positionOf(const toml::value& value, const LineEnds& line_ends) {
  const toml::detail::region& at = regionOf(value);
  const auto before = std::lower_bound(line_ends.begin(), line_ends.end(), at.first() - at.begin());
  return {static_cast<int>(before - line_ends.begin()) + 1, static_cast<int>(at.before()) + 1,
          std::max(1, static_cast<int>(at.size())), -1};
}

// The characters of a scalar in the text.
std::string spellingOf(const toml::value& value) {
  return regionOf(value).str();
}

std::string withoutUnderscores(std::string text) {
  text.erase(std::remove(text.begin(), text.end(), '_'), text.end());
  return text;
}

// toml11 clamps integers beyond 64 bits and turns 1e400 into the largest double, silently.
void readInteger(const toml::value& value, TomlNode& node) {
  node.integer = value.as_integer();
  std::string digits = withoutUnderscores(node.text);
  int base = 10;
  if (digits.size() > 2 && digits[0] == '0' &&
      !std::isdigit(static_cast<unsigned char>(digits[1]))) {
    base = digits[1] == 'x' ? 16 : (digits[1] == 'o' ? 8 : 2);
    digits.erase(0, 2);
  }
  errno = 0;
  const long long read = std::strtoll(digits.c_str(), nullptr, base);
  node.overflows = errno == ERANGE;
  if (!node.overflows && !digits.empty())
    node.integer = read;
}

void readReal(const toml::value& value, TomlNode& node) {
  node.real = value.as_floating();
  const std::string digits = withoutUnderscores(node.text);
  if (digits.empty() || digits.find_first_of("0123456789") == std::string::npos)
    return; // inf, nan
  node.real = std::strtod(digits.c_str(), nullptr);
  node.overflows = std::isinf(node.real);
}

TomlNode convert(const toml::value& value, const LineEnds& line_ends);

// The key stands before the value, on the same line.
Position keyPosition(const std::string& key, const toml::value& value, const TomlNode& node) {
  if (value.is_table() && node.at.column == 1) // a header or a dotted key
    return node.at;
  const std::string line = regionOf(value).line();
  const std::size_t before = static_cast<std::size_t>(std::max(0, node.at.column - 1));
  const std::size_t found =
      std::min(before, line.size()) == 0 ? std::string::npos : line.rfind(key, before - 1);
  if (found == std::string::npos)
    return node.at;
  return {node.at.line, static_cast<int>(found) + 1, std::max<int>(1, static_cast<int>(key.size())),
          -1};
}

void convertTable(const toml::value& value, const LineEnds& line_ends, TomlNode& node) {
  node.kind = TomlNode::Kind::table;
  for (const auto& [key, member] : value.as_table()) {
    node.members.emplace_back(key, convert(member, line_ends));
    TomlNode& last = node.members.back().second;
    last.key_at = keyPosition(key, member, last);
  }
  std::sort(node.members.begin(), node.members.end(), [](const auto& a, const auto& b) {
    const auto rank = [](const auto& m) {
      return std::make_tuple(m.second.at.line, m.second.at.column, m.first);
    };
    return rank(a) < rank(b);
  });
}

TomlNode convert(const toml::value& value, const LineEnds& line_ends) {
  TomlNode node;
  node.at = positionOf(value, line_ends);
  switch (value.type()) {
  case toml::value_t::boolean:
    node.kind = TomlNode::Kind::boolean;
    node.boolean = value.as_boolean();
    break;
  case toml::value_t::integer:
    node.kind = TomlNode::Kind::integer;
    node.text = spellingOf(value);
    readInteger(value, node);
    break;
  case toml::value_t::floating:
    node.kind = TomlNode::Kind::real;
    node.text = spellingOf(value);
    readReal(value, node);
    break;
  case toml::value_t::string:
    node.kind = TomlNode::Kind::text;
    node.text = value.as_string().str;
    break;
  case toml::value_t::array:
    node.kind = TomlNode::Kind::list;
    for (const toml::value& entry : value.as_array())
      node.entries.push_back(convert(entry, line_ends));
    break;
  case toml::value_t::table:
    convertTable(value, line_ends, node);
    break;
  default:
    node.kind = TomlNode::Kind::date;
    node.text = spellingOf(value);
    break;
  }
  return node;
}

// toml11 recurses into brackets and dotted keys, and scans a line once for each of its values: what
// is deeper or longer than in any deck is refused before it exhausts the stack or patience.
void checkShape(const std::string& text) {
  constexpr int deepest = 64, longest_line = 16384;
  int depth = 0, dots = 0, line = 1, column = 0; // dots since the key began
  std::string quote; // that closes the present string
  bool comment = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    ++column;
    if (c == '\n') {
      ++line;
      column = dots = 0;
      comment = false;
      if (quote.size() == 1)
        quote.clear();
    } else if (column > longest_line) {
      throw TomlSyntaxError({line, 1, 1, -1}, "a line that is too long",
                            "at most " + std::to_string(longest_line) + " bytes");
    } else if (comment) {
      continue;
    } else if (!quote.empty()) {
      if (c == '\\' && quote[0] == '"' && i + 1 < text.size() && text[i + 1] != '\n') {
        ++i, ++column;
      } else if (text.compare(i, quote.size(), quote) == 0) {
        i += quote.size() - 1;
        quote.clear();
      }
    } else if (c == '"' || c == '\'') {
      quote = text.compare(i, 3, std::string(3, c)) == 0 ? std::string(3, c) : std::string(1, c);
      i += quote.size() - 1;
    } else if (c == '#') {
      comment = true;
    } else if (c == '.') {
      if (++dots >= deepest)
        throw TomlSyntaxError({line, column, 1, -1}, "a dotted key of too many names",
                              "at most " + std::to_string(deepest));
    } else if (c == '=' || c == ',') {
      dots = 0;
    } else if (c == '[' || c == '{') {
      dots = 0;
      if (++depth > deepest)
        throw TomlSyntaxError({line, column, 1, -1}, "brackets nested too deeply",
                              "at most " + std::to_string(deepest) + " open brackets");
    } else if (c == ']' || c == '}') {
      depth = std::max(0, depth - 1);
    }
  }
}

std::string withoutFunctionName(std::string sentence) {
  for (const std::string prefix : {"[error] ", "toml::"})
    if (sentence.compare(0, prefix.size(), prefix) == 0)
      sentence.erase(0, prefix.size());
  const std::size_t colon = sentence.find(": ");
  const std::size_t blank = sentence.find(' ');
  if (colon != std::string::npos && blank > colon) // "parse_array: text"
    sentence.erase(0, colon + 2);
  while (!sentence.empty() && (sentence.back() == '.' || sentence.back() == ' '))
    sentence.pop_back();
  return sentence.empty() ? "invalid TOML" : sentence;
}

// A message of toml11 holds its excerpts as " 12 | the line", each followed by a line of marks and
// a remark. The last of them that is a line of the text is the place; the exception's own location
// may be that of a part of it.
TomlSyntaxError readMessage(const std::string& message, const std::vector<std::string>& lines,
                            Position fallback) {
  const std::vector<std::string> parts = splitLines(message);
  Position at = fallback;
  std::string remark;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    char* end = nullptr;
    const long number = std::strtol(parts[i].c_str(), &end, 10);
    if (end == parts[i].c_str() || std::string(end).compare(0, 3, " | ") != 0)
      continue;
    const std::string excerpt(end + 3);
    if (number < 1 || number > static_cast<long>(lines.size()) || excerpt != lines[number - 1])
      continue;
    at = {static_cast<int>(number), 1, 1, -1};
    if (i + 1 >= parts.size())
      continue;
    const std::string& marks = parts[i + 1];
    const std::size_t bar = marks.find("| ");
    const std::size_t mark = bar == std::string::npos ? bar : marks.find_first_not_of(' ', bar + 2);
    if (mark == std::string::npos)
      continue;
    at.column = static_cast<int>(mark - bar - 1);
    const std::size_t words = marks.find_first_not_of("^~- ", mark);
    remark = words == std::string::npos ? "" : marks.substr(words);
  }
  return syntaxErrorInWords(at, withoutFunctionName(parts.front()), remark);
}

toml::value parseText(const std::string& text) {
  const std::vector<std::string> lines = splitLines(text);
  const auto lineWithin = [&](std::size_t line) {
    return Position{static_cast<int>(std::min(std::max<std::size_t>(line, 1), lines.size())), 1, 1,
                    -1};
  };
  try {
    std::istringstream stream(text);
    return toml::parse(stream, "deck");
  } catch (const toml::exception& error) {
    TomlSyntaxError fault = readMessage(error.what(), lines, lineWithin(error.location().line()));
    if (hasNumberWithoutLeadingDigit(lines[static_cast<std::size_t>(fault.at.line - 1)]))
      fault.expected = "a digit before the point of a number, such as -0.5 for -.5";
    throw fault;
  } catch (const std::exception& error) {
    throw readMessage(error.what(), lines, lineWithin(lines.size()));
  }
}

} // namespace

const TomlNode* TomlNode::member(const std::string& name) const {
  for (const auto& [key, node] : members)
    if (key == name)
      return &node;
  return nullptr;
}

TomlNode* TomlNode::member(const std::string& name) {
  return const_cast<TomlNode*>(static_cast<const TomlNode*>(this)->member(name));
}

std::string TomlNode::describe() const {
  switch (kind) {
  case Kind::boolean:
    return boolean ? "true" : "false";
  case Kind::integer:
    return "the integer " + text;
  case Kind::real:
    return "the real " + text;
  case Kind::text:
    return "the text \"" + (text.size() > 60 ? text.substr(0, 57) + "..." : text) + "\"";
  case Kind::date:
    return "the date " + text;
  case Kind::list:
    return "a list of " + std::to_string(entries.size());
  case Kind::table:
    break;
  }
  return "a table";
}

std::string normalizeText(std::string text) {
  if (text.compare(0, 3, "\xEF\xBB\xBF") == 0)
    text.erase(0, 3);
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i)
    if (text[i] != '\r' || i + 1 == text.size() || text[i + 1] != '\n')
      out += text[i];
  return out;
}

std::vector<std::string> splitLines(const std::string& text) {
  std::vector<std::string> lines;
  std::size_t begin = 0;
  while (true) {
    const std::size_t end = text.find('\n', begin);
    lines.push_back(text.substr(begin, end == std::string::npos ? end : end - begin));
    if (end == std::string::npos || end + 1 == text.size())
      return lines;
    begin = end + 1;
  }
}

bool hasNumberWithoutLeadingDigit(const std::string& text) {
  const auto isDigit = [&](std::size_t i) {
    return i < text.size() && std::isdigit(static_cast<unsigned char>(text[i])) != 0;
  };
  for (std::size_t i = 0; i < text.size(); ++i)
    if (text[i] == '.' && isDigit(i + 1) &&
        (i == 0 || std::strchr(" \t=[{,+-", text[i - 1]) != nullptr))
      return true;
  return false;
}

TomlNode parseToml(const std::string& text) {
  checkShape(text);
  LineEnds line_ends;
  for (std::size_t i = 0; i < text.size(); ++i)
    if (text[i] == '\n')
      line_ends.push_back(static_cast<std::ptrdiff_t>(i));
  return convert(parseText(text), line_ends);
}

TomlNode parseTomlValue(const std::string& text) {
  const TomlNode root = parseToml("value = " + text + "\n");
  if (root.members.size() != 1 || root.members.front().first != "value")
    throw TomlSyntaxError({}, "more than one value", "one value");
  return root.members.front().second;
}

} // namespace brickwall::io
