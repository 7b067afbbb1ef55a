// Whether the enforcement of contact can work with what its host gives.
#pragma once

#include "contact/base/fixed_point.hpp"
#include "contact/enforcement/law/enforcement_config.hpp"
#include "contact/surface/surface.hpp"

#include <mpi.h>

#include <string>

namespace brickwall::contact {

// Ids of nodes and faces end here, where those of edges begin (edge_surface.cpp).
constexpr global_id first_edge_id = global_id(1) << 60;

// Collective. Throws InputError on all ranks, naming `function`, if a value of the configuration
// differs between ranks or is out of its range, for a surface that checkSurface() refuses or whose
// faces lack FaceAttributes, for ids from first_edge_id on, or for masses of too few nodes.
void checkEnforcementInput(const exec_space& space, MPI_Comm comm, const std::string& function,
                           const Surface& surface, const View<const double*>& node_mass,
                           const EnforcementConfig& config, const Quantum& quantum,
                           const LimbScale& energy_scale);

} // namespace brickwall::contact
