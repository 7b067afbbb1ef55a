// Stored energy of elastic bodies at half steps from values at whole steps; theory.md, equations
// (26) and (27):
//   S^{n+1/2} = (U^n + U^{n+1})/2 - (dt/4) v^{n+1/2} . (dU/du^{n+1} - dU/du^n).
// For linear springs S = u^n.K.u^{n+1}/2, whose change at constant dt is exactly minus the work of
// central differences. Otherwise the error is of higher order than that of the mean (U^n +
// U^{n+1})/2.
// If the drift changes from dt to dt', the kick in between has their mean length, and K + S changes
// by (dt' - dt)/4 times dU/du^n . (v^{n+1/2} - v^{n-1/2}): S^{n+1/2} - S^{n-1/2} = dU/du^n . (dt'
// v^{n+1/2} + dt v^{n-1/2})/2, whereas in the work both velocities have the factor (dt + dt')/4.
// change() accumulates these differences.
#pragma once

#include <cstdint>

namespace brickwall::mechanics {

class StoredGauge {
public:
  // Step n: U^n, `power` = dU/du^n . v^{n-1/2}, the work of -dU/du^n in the kick of length dt_kick,
  // and the length of the next drift. Without an energy the adjacent half steps have no value.
  void book(bool has_energy, double stored, double power, double work, double dt_kick, double dt) {
    _has_half = has_energy && _has_energy;
    if (_has_half)
      _half = 0.5 * (_stored + stored) - 0.25 * _dt * (power - _power_after);
    _has_energy = has_energy;
    _stored = stored;
    _power_before = power;
    _change += _change_now;
    _dt_before = _steps > 0 ? _dt : dt;
    ++_steps;
    correct(power, work, dt_kick, dt);
  }

  // A further kick by the same forces; `power` is that of the velocity before it.
  void correct(double power, double work, double dt_kick, double dt) {
    _power_after = -2 * work / dt_kick - power;
    _dt = dt;
    _change_now = 0.25 * (dt - _dt_before) * (_power_after - _power_before);
    // The sum of u^0.K.u^1/2 and the work of the first half kick, -dt u^0.K.(v^0 + v^{1/2})/4.
    if (_steps == 1)
      _change_now = 0, _initial = _stored + 0.25 * dt * (_power_after - _power_before);
  }

  bool hasHalf() const { return _has_half; }
  double half() const { return _half; } // of the half step before the last recorded step
  // Value of S before the start, so that S - initial() - change() is minus the work since then.
  double initial() const { return _initial; }
  // Change of the invariant with the lengths of the steps until the half step of half(); 0 for
  // constant steps.
  double change() const { return _change; }

private:
  std::int64_t _steps = 0;
  bool _has_energy = false, _has_half = false;
  double _stored = 0, _half = 0, _initial = 0;
  double _power_before = 0, _power_after = 0; // dU/du^n . v^{n-1/2} and . v^{n+1/2}
  double _dt = 0, _dt_before = 0;
  double _change = 0, _change_now = 0; // until half(); by the last recorded step
};

} // namespace brickwall::mechanics
