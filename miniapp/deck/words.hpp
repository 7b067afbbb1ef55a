// The words of each enumeration: one table, which the schema of the deck, its reader, the resolved
// deck and all reports use.
#pragma once

#include "contact/enforcement/law/enforcement_config.hpp"
#include "contact/surface/search_config.hpp"
#include "io/exodus/results_writer.hpp"
#include "io/wall/wall_layout.hpp"
#include "mechanics/element/material.hpp"
#include "miniapp/deck/config.hpp"

#include <string>
#include <vector>

namespace brickwall::miniapp {

template <class Enum>
struct Word {
  const char* word;
  Enum value;
  const char* former = nullptr; // a word that decks may still use for it, with a warning
};
template <class Enum>
using Words = std::vector<Word<Enum>>;

// In the order in which `brickwall --keys` lists them.
Words<UnitSystem> wordsOf(UnitSystem);
Words<io::WallEnds> wordsOf(io::WallEnds);
Words<mechanics::MaterialModel> wordsOf(mechanics::MaterialModel);
Words<Formulation> wordsOf(Formulation);
Words<NodalMass> wordsOf(NodalMass);
Words<PulseKind> wordsOf(PulseKind);
Words<Distribution> wordsOf(Distribution);
Words<contact::Scheme> wordsOf(contact::Scheme);
Words<SelfContact> wordsOf(SelfContact);
Words<GuardAction> wordsOf(GuardAction);
Words<contact::SearchMethod> wordsOf(contact::SearchMethod);
Words<Decomposition> wordsOf(Decomposition);
Words<Rebalance> wordsOf(Rebalance);
Words<StepBound> wordsOf(StepBound);
Words<io::FileFormat> wordsOf(io::FileFormat);
Words<Precision> wordsOf(Precision);
Words<OutputField> wordsOf(OutputField);

template <class Enum>
const char* nameOf(Enum value) {
  for (const Word<Enum>& entry : wordsOf(value))
    if (entry.value == value)
      return entry.word;
  return "";
}

// `fallback` where no enumerator has this word.
template <class Enum>
Enum enumeratorOf(const std::string& word, Enum fallback) {
  for (const Word<Enum>& entry : wordsOf(fallback))
    if (entry.word == word)
      return entry.value;
  return fallback;
}

} // namespace brickwall::miniapp
