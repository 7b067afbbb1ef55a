// Texts of others in messages.
#pragma once

#include <cstring>
#include <string>

namespace brickwall::io {

// The text with `?` for the bytes that a terminal takes for commands, but those in `kept`.
inline std::string terminalText(std::string text, const char* kept = "\t\n") {
  for (char& c : text)
    if ((static_cast<unsigned char>(c) < 32 && (c == 0 || !std::strchr(kept, c))) || c == 127)
      c = '?';
  return text;
}

} // namespace brickwall::io
