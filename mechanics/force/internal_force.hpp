// Internal forces of all elements, in fixed point: one-point hexahedra with physical stabilisation
// (hex8_one_point.hpp) or full 2x2x2 integration (hex8_full.hpp). Each element's force is rounded
// once, as 7 Walsh-Hadamard modes of 3 components, and transformed to the corners in integers
// (theory.md, equation (23)), so an element's corner forces sum to exactly zero and totals do not
// depend on the order of summation.
#pragma once

#include "mechanics/element/bulk_viscosity.hpp"
#include "mechanics/force/lattice/lattice_tiles.hpp"
#include "mechanics/force/packs/pack_forces.hpp"
#include "mechanics/mesh/brick_lattice.hpp"
#include "mechanics/mesh/element_failure.hpp"
#include "mechanics/mesh/hex_mesh.hpp"
#include "mechanics/mesh/nodal_state.hpp"

#include <cstdint>
#include <vector>

namespace brickwall::mechanics {

// F = max over elements and ranks of (lambda + 2 mu) h_max^2, the force at a strain of one. From
// input data only. Collective.
double forceScale(const exec_space& space, MPI_Comm comm, const HexMesh& mesh);

// Sets the columns of all kinds that act to zero; the others are zero.
void zeroForces(const exec_space& space, const NodalForces& forces);

// How InternalForce computes the elements of lattices (brick_lattice.hpp); all methods give the
// same bits.
enum class LatticeMethod {
  none, // as all other elements
  planes, // plane by plane in SIMD lanes (lattice_force.hpp)
  tiles // tile by tile by teams of threads (tile_force.hpp), for devices
};
constexpr LatticeMethod fastest_lattice_method =
    simd_width > 1 ? LatticeMethod::planes : LatticeMethod::tiles;

struct InternalForceResult {
  LimbSums<num_stored_energies> energy; // zero unless requested
  ElementFailure failure; // of this rank
  // largest l |tr D|/c_d of this rank's elements in compression; 0 without viscosity
  double compression_rate = 0;
  bool has_energy = false;
};

class InternalForce {
public:
  // Finds congruent bodies, stores the geometry of the general elements (about 370 B each) and
  // divides the bodies into chunks. `energy_scale` is the scale of the stored-energy sums,
  // `threads` the number of threads that share the work (0: all). Results depend neither on
  // `threads` nor on `lattice_method`, which applies to one-point elements. Collective.
  InternalForce(const exec_space& space, MPI_Comm comm, const HexMesh& mesh, ElementKind kind,
                Quantum quantum, LimbScale energy_scale, int threads = 0,
                LatticeMethod lattice_method = fastest_lattice_method);

  // mechanics::zeroForces() before add() with this viscosity, but for the columns internal_force
  // where add() stores forces.
  void zeroForces(const exec_space& space, const BulkViscosity& viscosity,
                  const NodalForces& forces) const;

  // Adds the elements' forces at X + u to the columns internal_force, which are zero before where
  // zeroForces() sets them. `displacement` is u [node][xyz]. Failed elements (J <= 0, NaN, a mode
  // beyond the fixed-point range) add nothing and are reported. Not collective; fences.
  InternalForceResult add(const exec_space& space, const View<const double* [3]>& displacement,
                          const NodalForces& forces, bool with_energy);
  // The same with bulk viscosity at the velocity v^{n-1/2} [node][xyz], added to the columns
  // viscous_force, which must exist if viscosity.any(). Output fields do not contain it.
  InternalForceResult add(const exec_space& space, const View<const double* [3]>& displacement,
                          const View<const double* [3]>& velocity, const BulkViscosity& viscosity,
                          const NodalForces& forces, bool with_energy);

  // The same in two parts: the second waits for the device, if the host has not waited since, and
  // gives the result.
  void launch(const exec_space& space, const View<const double* [3]>& displacement,
              const View<const double* [3]>& velocity, const BulkViscosity& viscosity,
              const NodalForces& forces, bool with_energy);
  InternalForceResult result(const exec_space& space);

  // add() omits the elements of bodies [row of HexMesh::bodies] whose flag is set at the time of
  // the call: the bodies at rest (resting_bodies.hpp).
  void skipRestingBodies(const View<const int*>& is_resting) { _is_resting = is_resting; }

  // Adds the forces of the free bricks, which add() omits.
  void addSkippedLattices(const exec_space& space, const View<const double* [3]>& displacement,
                          const NodalForces& forces) const;

  // Computes stress and energy density of every element at X + u; Views are grown. Not collective.
  void computeFields(const exec_space& space, const View<const double* [3]>& displacement,
                     ElementFields& fields) const;

  ElementKind kind() const { return _kind; }
  std::int64_t numCongruentElems() const { return _num_congruent_elems; }
  std::int64_t numLatticeElems() const; // that need no connectivity without viscosity

  // Lattices of this rank. add() omits those of the rows `free_lattices` after skipLattices(), for
  // free_bricks.hpp.
  const LatticeTables& lattices() const { return _lattices; }
  void skipLattices(const exec_space& space, const std::vector<int>& free_lattices);
  int threads() const { return _threads; }
  LimbScale energyScale() const { return _energy_scale; }
  const Quantum& quantum() const { return _quantum; }

  const ElementTables& tables() const { return _tables; }

private:
  // Of the method in use.
  const std::vector<BrickLattice>& hostLattices() const {
    return _tiles.any() ? _tiles.on_host : _lattices.on_host;
  }

  ElementTables _tables;
  LatticeTables _lattices; // only with LatticeMethod::planes
  LatticeTiles _tiles; // only with LatticeMethod::tiles
  View<LatticeSlab*> _slabs, _skipped_slabs; // swept by add(), omitted by add()
  std::vector<ChunkGroup> _groups;
  View<const int*> _is_resting;
  bool _all_in_lattices = false;
  int _threads = 1;
  ElementKind _kind;
  Quantum _quantum;
  LimbScale _energy_scale;
  std::int64_t _num_congruent_elems = 0;
  LaunchedSums<ForceSums> _sums; // of launch(), until result()
  ForceSums _lattice_sums; // likewise
  bool _with_energy = false; // likewise
};

} // namespace brickwall::mechanics
