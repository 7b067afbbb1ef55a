#include "miniapp/deck/words.hpp"

namespace brickwall::miniapp {

const Words<io::WallEnds>& wordsOf(io::WallEnds) {
  static const Words<io::WallEnds> words = {{"flush", io::WallEnds::flush},
                                            {"ragged", io::WallEnds::ragged}};
  return words;
}
const Words<mechanics::MaterialModel>& wordsOf(mechanics::MaterialModel) {
  using mechanics::MaterialModel;
  static const Words<MaterialModel> words = {{"neo_hookean", MaterialModel::neo_hookean},
                                             {"svk", MaterialModel::svk},
                                             {"linear", MaterialModel::linear}};
  return words;
}
const Words<Formulation>& wordsOf(Formulation) {
  static const Words<Formulation> words = {{"one_point", Formulation::one_point, "tlps"},
                                           {"full", Formulation::full}};
  return words;
}
const Words<PulseShape>& wordsOf(PulseShape) {
  static const Words<PulseShape> words = {{"step", PulseShape::step},
                                          {"half_sine", PulseShape::half_sine},
                                          {"sin_squared", PulseShape::sin_squared},
                                          {"triangle", PulseShape::triangle},
                                          {"friedlander", PulseShape::friedlander}};
  return words;
}
const Words<Distribution>& wordsOf(Distribution) {
  static const Words<Distribution> words = {{"uniform", Distribution::uniform},
                                            {"gaussian", Distribution::gaussian}};
  return words;
}
const Words<contact::Scheme>& wordsOf(contact::Scheme) {
  static const Words<contact::Scheme> words = {{"energy_neutral", contact::Scheme::energy_neutral},
                                               {"penalty", contact::Scheme::penalty}};
  return words;
}
const Words<SelfContact>& wordsOf(SelfContact) {
  static const Words<SelfContact> words = {{"auto", SelfContact::automatic},
                                           {"never", SelfContact::never},
                                           {"always", SelfContact::always}};
  return words;
}
const Words<GuardAction>& wordsOf(GuardAction) {
  static const Words<GuardAction> words = {
      {"cut", GuardAction::cut}, {"stop", GuardAction::stop}, {"off", GuardAction::off}};
  return words;
}
const Words<contact::SearchMethod>& wordsOf(contact::SearchMethod) {
  using contact::SearchMethod;
  static const Words<SearchMethod> words = {{"cluster", SearchMethod::cluster},
                                            {"paper", SearchMethod::paper},
                                            {"reference", SearchMethod::reference}};
  return words;
}
const Words<StepBound>& wordsOf(StepBound) {
  static const Words<StepBound> words = {{"lanczos", StepBound::lanczos},
                                         {"element", StepBound::element}};
  return words;
}
// The netCDF-3 formats are one for the writer.
const Words<io::FileFormat>& wordsOf(io::FileFormat) {
  static const Words<io::FileFormat> words = {{"64bit_offset", io::FileFormat::offset64, "classic"},
                                              {"netcdf4", io::FileFormat::netcdf4}};
  return words;
}
const Words<Precision>& wordsOf(Precision) {
  static const Words<Precision> words = {{"single", Precision::float32},
                                         {"double", Precision::float64}};
  return words;
}

} // namespace brickwall::miniapp
