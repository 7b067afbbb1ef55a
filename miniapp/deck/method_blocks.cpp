// [contact], [search], [partition], [skip] and [time]
#include "mechanics/stability/stable_time_step.hpp"
#include "miniapp/deck/block_keys.hpp"
#include "miniapp/deck/deck_blocks.hpp"

namespace brickwall::miniapp {
namespace {

using io::BlockKind;
using io::BlockRule;

void contactKeys(BlockKeys& keys, ContactConfig& contact) {
  keys.add("enabled", contact.enabled, "whether contact is searched and enforced");
  // Node and face together reach twice as far: not through a brick of one element.
  keys.add("tolerance", contact.tolerance,
           "inflation of the search boxes of nodes and faces over the shortest element edge; a new "
           "contact may be twice as deep; the boxes reach at least 0.375 of the larger of "
           "lateral_tolerance and edge_tolerance of the longest edge")
      .above(0)
      .atMost(0.45);
  keys.add(
      "scheme", contact.scheme,
      "energy_neutral: penalty, with the first and last step of a contact corrected so that energy "
      "is conserved; penalty: without the correction");
  keys.add(
          "penalty", contact.penalty,
          "stiffness s = k dt^2/m of a contact (k its stiffness, m its reduced mass, dt the step); "
          "the default is less with contact.damping; stiffer contact may shorten the step; below "
          "1.55 with edges")
      .above(0)
      .below(1.95);
  keys.add("lateral_tolerance", contact.lateral_tolerance,
           "a node up to this far beyond the edge of a face touches it; in half lengths of the "
           "face; above 0.1 contacts that slide over curved surfaces do not keep their energy")
      .atLeast(1e-3)
      .atMost(0.5);
  keys.add("edge_tolerance", contact.edge_tolerance,
           "the same beyond the edges of a body; over this distance the force fades out")
      .atLeast(1e-3)
      .atMost(0.5);
  keys.add("friction", contact.friction, "Coulomb's coefficient of friction")
      .atLeast(0)
      .atMost(100);
  keys.add("friction_stiffness", contact.friction_stiffness,
           "tangential over normal stiffness of a contact; only with friction")
      .above(0)
      .atMost(1);
  keys.add("damping", contact.damping,
           "damping of a contact over its critical damping; 0: elastic contact; above 1 contact "
           "only becomes softer, and more steps are cut")
      .atLeast(0)
      .atMost(10); // with more, contact is so soft that the guard leaves no step of use
  keys.add("edges", contact.edges, "whether edges touch edges too, beside nodes and faces");
  keys.add("self", contact.self,
           "contact of a body with itself; auto: never for walls, always for Exodus meshes");
  keys.add(
      "guard", contact.guard,
      "if a node could pass through a face within a step: cut shortens the step, stop ends the "
      "run, off goes on");
}

void searchKeys(BlockKeys& keys, SearchConfig& search) {
  keys.add("method", search.method,
           "cluster: a kept order and boxes of eight, the fastest; paper: that of Hansen et al. "
           "(2016); reference: plain loops, slow; the contact forces are the same");
  keys.add(
      "decomposition", search.decomposition,
      "where faces are searched and enforced: primary: on the ranks of their elements; surface: "
      "on ranks of equal work, by Zoltan; auto: on these where that pays (brickwall run)");
  keys.add("jitter", search.jitter,
           "random displacement of the nodes, over an edge (brickwall search)")
      .atLeast(0)
      .below(0.5);
  keys.add("drift", search.drift,
           "largest displacement of a brick per step, over an edge (brickwall search)")
      .atLeast(0)
      .atMost(10);
  keys.add("repetitions", search.repetitions, "counted searches (brickwall search)")
      .atLeast(1)
      .atMost(1e9);
  keys.add("warmup", search.warmup, "searches before the counted ones (brickwall search)")
      .atLeast(0)
      .atMost(1e9);
  keys.add("audit", search.audit,
           "steps between audits, which test all pairs by plain loops and count those that the "
           "lists miss; 0: none")
      .atLeast(0)
      .atMost(1e15);
  keys.add("seed", search.seed, "seed of jitter, drift and shuffle").atLeast(0);
  keys.add("local", search.local,
           "whether the local search is done after the global search (brickwall search)");
  keys.add("shuffle", search.shuffle,
           "whether local nodes and faces are in random order (brickwall search)");
}

void reuseKeys(BlockKeys& keys, SearchConfig& search) {
  keys.add("margin", search.margin,
           "added to the boxes, over the shortest element edge; a new search is made when a node "
           "has moved half of it; 0: a search of nodes in every step; for brickwall search the "
           "default is 0")
      .atLeast(0)
      .atMost(10);
}

void partitionKeys(BlockKeys& keys, PartitionConfig& partition) {
  keys.add(
      "rebalance", partition.rebalance,
      "whether elements move to ranks of equal work during the run (Zoltan): never; auto: if "
      "the estimate, which knows the work of elements only, says that it pays; always: at every "
      "interval");
  keys.add("interval", partition.interval, "steps between checks of the balance")
      .atLeast(1)
      .atMost(1e15);
}

void skipKeys(BlockKeys& keys, SkipConfig& skip) {
  keys.add("resting_bodies", skip.resting_bodies,
           "skip elements and nodes of bodies that have not yet been moved");
  keys.add("free_bricks", skip.free_bricks,
           "skip forces and loads of bricks that step independently, without contact");
  keys.add("lattices", skip.lattices,
           "skip the connectivity of bricks whose elements form a lattice");
  keys.add("stationary_contact", skip.stationary_contact,
           "skip contact of nodes and faces that have not moved, or not far enough to touch")
      .formerly("still_contact");
}

void timeKeys(BlockKeys& keys, TimeConfig& time) {
  keys.add("end", time.end, "time at which the run ends").in("s").mustBeGiven().above(0);
  keys.add("safety", time.safety, "length of the steps over that of the stable step")
      .above(0)
      .atMost(1);
  keys.add(
      "bound", time.bound,
      "lanczos: stable step from the largest frequency of whole bodies; element: from the worst "
      "element by itself, which gives shorter steps");
  keys.add("steps", time.steps, "number of steps after which the run ends, even before `end`")
      .atLeast(1)
      .atMost(1e15);
  keys.add("check_interval", time.check_interval, "steps between checks of the stable step")
      .atLeast(1)
      .atMost(1e15);
}

} // namespace

io::Schema methodBlocks() {
  BlockRule skip{"skip", BlockKind::single,
                 "work that the scene does not need is skipped; no bit of the results depends on "
                 "it"};
  skip.former_name = "spare";
  BlockRule time{"time", BlockKind::single, "time steps"};
  time.required = true;
  return {
      withKeys({"contact", BlockKind::single, "contact between bodies"}, contactKeys),
      withKeys({"search", BlockKind::single, "the contact search"}, searchKeys),
      withKeys({"search.reuse", BlockKind::single,
                "candidate lists are kept over several steps; the contact forces are the same bit "
                "for bit"},
               reuseKeys),
      withKeys({"partition", BlockKind::single,
                "elements on ranks; no bit of the results depends on it"},
               partitionKeys),
      withKeys(skip, skipKeys),
      withKeys(time, timeKeys),
  };
}

void readMethods(io::Deck& deck, Config& config) {
  ContactConfig& contact = config.contact;
  readBlock(deck, "contact", contactKeys, contact);
  if (!deck.has("contact", "penalty")) {
    contact.penalty = mechanics::penaltyForMassFraction(contact.penalty, contact.damping);
    deck.assignReal("contact", "penalty", contact.penalty);
  } else if (contact.enabled && deck.isGood("contact", "penalty") &&
             deck.isGood("contact", "damping")) {
    if (!(contact.penalty < mechanics::largestPenalty(contact.damping, contact.edges)))
      deck.complain("contact", "penalty", "a penalty that leaves no stable step of use",
                    "a value " + mechanics::boundOfPenalty(contact.damping, contact.edges));
  }
  readBlock(deck, "search", searchKeys, config.search);
  readBlock(deck, "search.reuse", reuseKeys, config.search);
  config.search.has_margin = deck.has("search.reuse", "margin");
  readBlock(deck, "partition", partitionKeys, config.partition);
  readBlock(deck, "skip", skipKeys, config.skip);
  readBlock(deck, "time", timeKeys, config.time);
}

} // namespace brickwall::miniapp
