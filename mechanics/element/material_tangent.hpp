// First elasticity tensor A = d^2 W/dH^2 of the elastic materials, for the stable time step of a
// deformed element; theory.md, equation (8).
#pragma once

#include "mechanics/element/hex8_geometry.hpp"
#include "mechanics/element/material.hpp"

namespace brickwall::mechanics {

// A[3 i + j][3 k + l] = dP_ij/dH_kl. Returns false and leaves A unset if J is not positive (linear:
// if H is not a number).
// neo-Hookean: mu d_ik d_jl + lambda G_ij G_kl + (mu - lambda ln J) G_il G_kj with G = F^-T;
// St. Venant-Kirchhoff: d_ik S_jl + lambda F_ij F_kl + mu (F_il F_kj + (F F^T)_ik d_jl).
KOKKOS_INLINE_FUNCTION bool materialTangent(const double (&H)[3][3], const Material& material,
                                            double (&A)[9][9]) {
  const double lambda = material.lambda(), mu = material.mu();
  double F[3][3], G[3][3];
  deformationGradient(H, F);
  const double d = volumeChange(H), J = 1 + d;
  if (!(J > 0) && !(material.model == MaterialModel::linear && J == J))
    return false;
  cofactors(F, G);
  const double mixed = mu - lambda * (J > 0 ? logOnePlus(d) : 0.0);
  double S[3][3], B[3][3], trace = 0; // S: second Piola-Kirchhoff, B = F F^T
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const double E2 =
          H[i][j] + H[j][i] + H[0][i] * H[0][j] + H[1][i] * H[1][j] + H[2][i] * H[2][j];
      S[i][j] = mu * E2;
      trace += i == j ? E2 : 0.0;
      B[i][j] = F[i][0] * F[j][0] + F[i][1] * F[j][1] + F[i][2] * F[j][2];
    }
  for (int i = 0; i < 3; ++i)
    S[i][i] += 0.5 * lambda * trace;
  for (int r = 0; r < 9; ++r)
    for (int c = 0; c < 9; ++c) {
      const int i = r / 3, j = r % 3, k = c / 3, l = c % 3;
      const double ik = i == k, jl = j == l;
      if (material.model == MaterialModel::neo_hookean)
        A[r][c] = mu * ik * jl + (lambda * G[i][j] * G[k][l] + mixed * G[i][l] * G[k][j]) / (J * J);
      else if (material.model == MaterialModel::svk)
        A[r][c] =
            ik * S[j][l] + lambda * F[i][j] * F[k][l] + mu * (F[i][l] * F[k][j] + B[i][k] * jl);
      else
        A[r][c] = lambda * (i == j) * (k == l) + mu * (ik * jl + (i == l) * (j == k));
    }
  return true;
}

} // namespace brickwall::mechanics
