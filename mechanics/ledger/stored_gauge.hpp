// Stored energy of elastic bodies at half steps, from what is known at whole steps:
//   S^{n+1/2} = (U^n + U^{n+1})/2 - (dt/4) v^{n+1/2} . (dU/du^{n+1} - dU/du^n).
// For linear springs it is u^n.K.u^{n+1}/2, whose change at constant dt is minus the work of central differences exactly;
// else the error is of higher order than that of the mean (U^n + U^{n+1})/2.
//
// Where the drift changes from dt to dt', the kick between being of their mean length, K + S changes by (dt' - dt)/4 times
// dU/du^n . (v^{n+1/2} - v^{n-1/2}): S^{n+1/2} - S^{n-1/2} = dU/du^n . (dt' v^{n+1/2} + dt v^{n-1/2})/2 against the work, in which
// both velocities have (dt + dt')/4. So the invariant of the new step is another number, and that much is what it is another by: change().
#pragma once

#include <cstdint>

namespace brickwall::mechanics {

class StoredGauge {
public:
  // At step n: U^n, `power` = dU/du^n . v^{n-1/2}, the work of -dU/du^n in the kick of length dt_kick, and the drift to come.
  // Without an energy the half steps on either side have no value.
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

  // A further kick by the same forces; `power` is with the velocity before it.
  void correct(double power, double work, double dt_kick, double dt) {
    _power_after = -2 * work / dt_kick - power;
    _dt = dt;
    _change_now = 0.25 * (dt - _dt_before) * (_power_after - _power_before);
    // u^0.K.u^1/2 and the work of the first half kick, -dt u^0.K.(v^0 + v^{1/2})/4, add up to this.
    if (_steps == 1)
      _change_now = 0, _initial = _stored + 0.25 * dt * (_power_after - _power_before);
  }

  bool hasHalf() const { return _has_half; }
  double half() const { return _half; } // of the half step before the last booked step
  // What S would have been before the start, so that S - initial() - change() is minus the work since then.
  double initial() const { return _initial; }
  // By how much the steps' lengths have changed the invariant until the half step of half(); 0 if they never changed.
  double change() const { return _change; }

private:
  std::int64_t _steps = 0;
  bool _has_energy = false, _has_half = false;
  double _stored = 0, _half = 0, _initial = 0;
  double _power_before = 0, _power_after = 0; // dU/du^n . v^{n-1/2} and . v^{n+1/2}
  double _dt = 0, _dt_before = 0;
  double _change = 0, _change_now = 0; // until half(); by the last booked step
};

} // namespace brickwall::mechanics
