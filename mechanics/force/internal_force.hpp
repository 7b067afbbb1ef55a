// Internal forces of all elements, in fixed point: TL-PS one-point hexahedra (hex8_one_point.hpp) or full 2x2x2 integration
// (hex8_full.hpp). Each element's force is rounded once, as 7 Walsh-Hadamard modes of 3 components, and transformed to
// the corners in integers, so an element's corner forces sum to exactly zero and totals depend on no order.
#pragma once

#include "mechanics/element/bulk_viscosity.hpp"
#include "mechanics/force/packs/element_tables.hpp"
#include "mechanics/mesh/brick_lattice.hpp"
#include "mechanics/mesh/element_failure.hpp"
#include "mechanics/mesh/hex_mesh.hpp"
#include "mechanics/mesh/nodal_state.hpp"

namespace brickwall::mechanics {

// F = max over elements and ranks of (lambda + 2 mu) h_max^2: the force that a strain of one would make. From input
// data only. Collective.
double forceScale(const exec_space& space, MPI_Comm comm, const HexMesh& mesh);

// Sets all columns to zero.
void zeroForces(const exec_space& space, const NodalForces& forces);

struct InternalForceResult {
  LimbSums<num_stored_energies> energy; // zero when not asked for
  ElementFailure failure; // this rank's
  double compression_rate =
      0; // largest l |tr D|/c_d of this rank's elements in compression; 0 without viscosity
  bool has_energy = false;
};

class InternalForce {
public:
  // Finds congruent bodies, stores what the general elements need (about 370 B each) and cuts the bodies into chunks.
  // `energy_scale` is the scale of the stored-energy sums. `threads`: how many share the work (0: as many as run at
  // once); no result depends on it, nor on `with_lattices`: whether lattices are swept as such. Collective.
  InternalForce(const exec_space& space, MPI_Comm comm, const HexMesh& mesh, ElementKind kind,
                Quantum quantum, LimbScale energy_scale, int threads = 0,
                bool with_lattices = true);

  // Adds the elements' forces at X + u to the columns internal_force. `displacement` is u [node][xyz]. Failed elements (J <= 0, NaN, a mode beyond the range) add
  // nothing and are reported. Not collective; fences.
  InternalForceResult add(const exec_space& space, const View<const double* [3]>& displacement,
                          const NodalForces& forces, bool with_energy);
  // The same, and bulk viscosity at the velocity v^{n-1/2} [node][xyz] to the columns viscous_force, which must be there if
  // viscosity.any(). It is not part of the fields.
  InternalForceResult add(const exec_space& space, const View<const double* [3]>& displacement,
                          const View<const double* [3]>& velocity, const BulkViscosity& viscosity,
                          const NodalForces& forces, bool with_energy);

  // From now on add() leaves out the elements of the bodies [row of HexMesh::bodies] that are marked at that time: those that rest
  // (resting_bodies.hpp).
  void leaveOutResting(const View<const int*>& is_resting) { _is_resting = is_resting; }

  // The elements of free bricks, which add() leaves out, as add() would.
  void addLeftOut(const exec_space& space, const View<const double* [3]>& displacement,
                  const NodalForces& forces) const;

  // Stress and energy density of every element at X + u; Views are grown. Not collective.
  void computeFields(const exec_space& space, const View<const double* [3]>& displacement,
                     ElementFields& fields) const;

  ElementKind kind() const { return _kind; }
  std::int64_t numCongruentElems() const { return _num_congruent_elems; }

  // Lattices, and those whose elements add() leaves to others (free_bricks.hpp) from now on: rows of lattices().
  const LatticeTables& lattices() const { return _lattices; }
  void leaveOut(const exec_space& space, const std::vector<int>& free_lattices);
  int threads() const { return _threads; }
  LimbScale energyScale() const { return _energy_scale; }
  const Quantum& quantum() const { return _quantum; }

  const ElementTables& tables() const { return _tables; }

private:
  ElementTables _tables;
  LatticeTables _lattices; // empty on devices and for full integration
  View<LatticeSlab*> _slabs, _left_out; // of what add() sweeps, and of what it leaves out
  std::vector<ChunkGroup> _groups;
  View<const int*> _is_resting;
  bool _all_in_lattices = false;
  int _threads = 1;
  ElementKind _kind;
  Quantum _quantum;
  LimbScale _energy_scale;
  std::int64_t _num_congruent_elems = 0;
};

} // namespace brickwall::mechanics
