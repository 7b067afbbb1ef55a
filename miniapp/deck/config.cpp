#include "miniapp/deck/config.hpp"

#include "contact/base/error.hpp"
#include "contact/enforcement/law/contact_law.hpp"
#include "miniapp/deck/deck_blocks.hpp"
#include "miniapp/deck/unused_keys.hpp"

namespace brickwall::miniapp {
namespace {

// All but the verdict: the caller asks the deck for its faults.
Config readDeck(io::Deck& deck) {
  if (deck.hasName("case"))
    throw InputError(deck.path() + ": found [[case]], the mark of a study file, expected a deck; " +
                     "brickwall study " + deck.path() + " runs it");
  Config config;
  config.deck_path = deck.path();
  readScene(deck, config);
  readLoads(deck, config);
  readMethods(deck, config);
  readOutput(deck, config);
  warnOfUnusedKeys(config, deck);
  config.warnings = deck.warnings();
  return config;
}

} // namespace

const io::Schema& deckSchema() {
  static const io::Schema schema = [] {
    io::Schema all;
    for (const auto& part : {sceneBlocks(), loadBlocks(), methodBlocks(), outputBlocks()})
      all.insert(all.end(), part.begin(), part.end());
    return all;
  }();
  return schema;
}

const mechanics::Material* Config::materialOf(const std::string& block) const {
  for (const MaterialConfig& material : materials)
    if (material.block == block)
      return &material.material;
  return block == "half_brick" ? materialOf("brick") : nullptr;
}

Config readConfig(MPI_Comm comm, const std::string& deck_path,
                  const std::vector<std::string>& overrides) {
  io::Deck deck = io::Deck::read(comm, deck_path, overrides, deckSchema());
  Config config = readDeck(deck);
  deck.finish(comm);
  config.resolved_deck = deck.resolved();
  return config;
}

Config parseConfig(const std::string& deck_text, const std::string& deck_path,
                   const std::vector<std::string>& overrides) {
  io::Deck deck = io::Deck::parse(deck_text, deck_path, overrides, deckSchema());
  Config config = readDeck(deck);
  deck.finish();
  config.resolved_deck = deck.resolved();
  return config;
}

double boxTolerance(const ContactConfig& contact, double shortest_edge, double longest_edge) {
  const double beyond = 0.5 * maxOf(contact.lateral_tolerance, contact.edge_tolerance);
  return maxOf(contact.tolerance * shortest_edge, 0.5 * 1.5 * beyond * longest_edge);
}

bool dampsContacts(const ContactConfig& contact) {
  return contact.enabled && (contact.damping > 0 || contact::ContactLaw{contact}.maySettle());
}

double deepestActivation(const ContactConfig& contact, double shortest_edge) {
  return 2 * contact.tolerance * shortest_edge;
}

bool dropsSameBody(const Config& config) {
  const SelfContact self = config.contact.self;
  return !config.contact.enabled || self == SelfContact::never ||
         (self == SelfContact::automatic && config.wall.has_value());
}

contact::SearchConfig searchConfig(const Config& config, double tolerance, bool drop_same_body) {
  contact::SearchConfig search;
  search.method = config.search.method;
  search.node_tolerance = search.face_tolerance = tolerance;
  search.drop_same_body = drop_same_body;
  return search;
}

} // namespace brickwall::miniapp
