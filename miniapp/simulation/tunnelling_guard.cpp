#include "miniapp/simulation/tunnelling_guard.hpp"

#include "contact/base/error.hpp"

#include <sstream>

namespace brickwall::miniapp {

namespace {

constexpr double least_share_of_stable_step = 1e-3;

std::string describe(const EntityNames& names, const contact::PairMotion& pair) {
  std::ostringstream text;
  if (pair.is_of_edges)
    text << names.edge(pair.node);
  else
    text << names.node(pair.node);
  text << " of body " << pair.node_body << " moves by " << pair.motion << " against "
       << (pair.is_of_edges ? names.edge(pair.face) : names.face(pair.face)) << " of body "
       << pair.face_body << " in one step";
  return text.str();
}

} // namespace

TunnellingGuard::TunnellingGuard(const Config& config, double reach, double reference_step)
    : _action(config.contact.guard), _reference_step(reference_step),
      _shortest_step(least_share_of_stable_step * reference_step),
      _penalty(config.contact.penalty) {
  if (_action != GuardAction::off)
    _allowed = reach * minOf(0.5, config.contact.penalty);
}

double TunnellingGuard::shorten(double dt, const contact::PairMotion& pair, bool is_early,
                                std::int64_t step, double time, const EntityNames& names) {
  const double reserve = actsEarly(is_early) ? 0.8 : 1; // 3/4 of it is below early_share
  // the reference step in which the pair moves by the allowed motion
  const double sure = reserve * _allowed / (pair.motion / dt);
  const bool is_too_short = 0.5 * sure < _shortest_step;
  if (_action == GuardAction::cut && !is_too_short) {
    _reference_step = 0.75 * sure;
    return minOf(dt, 0.5 * sure);
  }
  std::ostringstream message;
  message << "contact could be missed in step " << step + 1 << " (from time " << time
          << "): " << describe(names, pair) << "; contact is reliable up to " << allowedMotion(dt)
          << ". ";
  if (is_too_short)
    message << "The step would have to decrease from " << dt << " to " << 0.5 * sure
            << ", below 1/1000 of the stable one. Slow the bodies down or raise contact.tolerance";
  else
    message << "contact.guard = \"cut\" shortens the step; a larger contact.tolerance or a smaller "
               "time.safety may also suffice";
  if (_penalty < 0.5)
    message << ". A larger contact.penalty helps too; it is " << _penalty
            << " (the default is less with contact.damping)";
  throw PhysicsError(message.str());
}

} // namespace brickwall::miniapp
