// [output], [output.checkpoint], [limits] and [limits.warn]
#include "miniapp/deck/block_keys.hpp"
#include "miniapp/deck/deck_blocks.hpp"

namespace brickwall::miniapp {
namespace {

using io::BlockKind;

void outputKeys(BlockKeys& keys, OutputConfig& output) {
  keys.add("interval", output.interval,
           "time between steps of the Exodus file; 0: first and last step only")
      .in("s")
      .atLeast(0);
  keys.add("history_interval", output.history_interval,
           "time between rows of history.csv; 0: a row for every step")
      .in("s")
      .atLeast(0);
  keys.add("balance", output.balance,
           "whether balance.csv is written, at the same times: work and times over the ranks");
  keys.add("fields", output.fields,
           "fields of the Exodus files, once each in any order; miniapp/output.md defines them");
  keys.add("file_format", output.file_format,
           "netCDF format of the Exodus files: 64bit_offset, or netcdf4, which is compressed");
  keys.add("precision", output.precision, "precision of the fields in the Exodus files");
}

void checkpointKeys(BlockKeys& keys, CheckpointConfig& checkpoint) {
  keys.add("steps", checkpoint.steps, "steps between checkpoints, from which --restart continues")
      .atLeast(1);
  keys.add("minutes", checkpoint.minutes, "wall clock time between checkpoints").in("min").above(0);
}

void gaugeKeys(BlockKeys& keys, GaugeValues& limits) {
  for (int g = 0; g < num_gauges; ++g)
    keys.add(gauge_rules[g].key, limits[g], gauge_rules[g].help).above(0);
}
void limitKeys(BlockKeys& keys, LimitsConfig& limits) {
  gaugeKeys(keys, limits.stop);
  keys.add("wall_time", limits.wall_time, "wall clock time after which the run ends")
      .in("s")
      .above(0);
}
void warnKeys(BlockKeys& keys, LimitsConfig& limits) {
  gaugeKeys(keys, limits.warn);
}

} // namespace

io::Schema outputBlocks() {
  return {
      withKeys({"output", BlockKind::single, "the files that are written"}, outputKeys),
      withKeys({"output.checkpoint", BlockKind::single,
                "restart files; with either key, one is also written at the end"},
               checkpointKeys),
      withKeys({"limits", BlockKind::single,
                "limits beyond which the run ends with FAIL; miniapp/README.md defines the error "
                "measures"},
               limitKeys),
      withKeys(
          {"limits.warn", BlockKind::single,
           "limits beyond which the run warns, once each; error measures are those of [limits]"},
          warnKeys),
  };
}

void readOutput(const io::Deck& deck, Config& config) {
  readBlock(deck, "output", outputKeys, config.output);
  readBlock(deck, "output.checkpoint", checkpointKeys, config.checkpoint);
  readBlock(deck, "limits", limitKeys, config.limits);
  readBlock(deck, "limits.warn", warnKeys, config.limits);
}

} // namespace brickwall::miniapp
