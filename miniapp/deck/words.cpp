#include "miniapp/deck/words.hpp"

namespace brickwall::miniapp {

Words<UnitSystem> wordsOf(UnitSystem) {
  return {{"m-kg-s", UnitSystem::m_kg_s},
          {"mm-t-s", UnitSystem::mm_t_s},
          {"mm-kg-ms", UnitSystem::mm_kg_ms},
          {"cm-g-us", UnitSystem::cm_g_us},
          {"none", UnitSystem::none}};
}
Words<io::WallEnds> wordsOf(io::WallEnds) {
  return {{"flush", io::WallEnds::flush}, {"ragged", io::WallEnds::ragged}};
}
Words<mechanics::MaterialModel> wordsOf(mechanics::MaterialModel) {
  using mechanics::MaterialModel;
  return {{"neo_hookean", MaterialModel::neo_hookean},
          {"svk", MaterialModel::svk},
          {"linear", MaterialModel::linear}};
}
Words<Formulation> wordsOf(Formulation) {
  return {{"one_point", Formulation::one_point, "tlps"}, {"full", Formulation::full}};
}
Words<NodalMass> wordsOf(NodalMass) {
  return {{"inertia", NodalMass::inertia}, {"row_sum", NodalMass::row_sum}};
}
Words<PulseKind> wordsOf(PulseKind) {
  return {{"step", PulseKind::step},
          {"half_sine", PulseKind::half_sine},
          {"sin_squared", PulseKind::sin_squared},
          {"triangle", PulseKind::triangle},
          {"friedlander", PulseKind::friedlander}};
}
Words<Distribution> wordsOf(Distribution) {
  return {{"uniform", Distribution::uniform}, {"gaussian", Distribution::gaussian}};
}
Words<contact::Scheme> wordsOf(contact::Scheme) {
  return {{"energy_neutral", contact::Scheme::energy_neutral},
          {"penalty", contact::Scheme::penalty}};
}
Words<SelfContact> wordsOf(SelfContact) {
  return {{"auto", SelfContact::automatic},
          {"never", SelfContact::never},
          {"always", SelfContact::always}};
}
Words<GuardAction> wordsOf(GuardAction) {
  return {{"cut", GuardAction::cut}, {"stop", GuardAction::stop}, {"off", GuardAction::off}};
}
Words<contact::SearchMethod> wordsOf(contact::SearchMethod) {
  using contact::SearchMethod;
  return {{"cluster", SearchMethod::cluster},
          {"paper", SearchMethod::paper},
          {"reference", SearchMethod::reference}};
}
Words<Decomposition> wordsOf(Decomposition) {
  return {{"primary", Decomposition::primary},
          {"surface", Decomposition::surface},
          {"auto", Decomposition::automatic}};
}
Words<Rebalance> wordsOf(Rebalance) {
  return {
      {"never", Rebalance::never}, {"auto", Rebalance::automatic}, {"always", Rebalance::always}};
}
Words<StepBound> wordsOf(StepBound) {
  return {{"lanczos", StepBound::lanczos}, {"element", StepBound::element}};
}
// The netCDF-3 formats are one for the writer.
Words<io::FileFormat> wordsOf(io::FileFormat) {
  return {{"64bit_offset", io::FileFormat::offset64, "classic"},
          {"netcdf4", io::FileFormat::netcdf4}};
}
Words<Precision> wordsOf(Precision) {
  return {{"single", Precision::float32}, {"double", Precision::float64}};
}
Words<OutputField> wordsOf(OutputField) {
  return {{"displacement", OutputField::displacement},
          {"velocity", OutputField::velocity},
          {"force_contact", OutputField::force_contact},
          {"contact_status", OutputField::contact_status},
          {"contact_gap", OutputField::contact_gap},
          {"contact_pressure", OutputField::contact_pressure},
          {"slip_velocity", OutputField::slip_velocity},
          {"slip_distance", OutputField::slip_distance},
          {"stress", OutputField::stress},
          {"pressure", OutputField::pressure},
          {"energy_density", OutputField::energy_density},
          {"von_mises", OutputField::von_mises},
          {"principal_stress", OutputField::principal_stress},
          {"strain_energy", OutputField::strain_energy},
          {"candidate_pairs", OutputField::candidate_pairs},
          {"search_time", OutputField::search_time},
          {"brick_id", OutputField::brick_id},
          {"processor_id", OutputField::processor_id}};
}

} // namespace brickwall::miniapp
