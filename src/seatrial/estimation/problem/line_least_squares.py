"""Least squares in the frequency domain: motions under forces of known lines (Pintelon & Schoukens 2012, section 9.2).

The motions are first reduced to one complex amplitude a line, by linear least squares in time; then the response of the
model is fitted to those amplitudes, with the information that the samples gave them. No hold of the input enters.
"""

from dataclasses import dataclass

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError
from seatrial.estimation.problem.free_parameters import FreeParameterProblem
from seatrial.estimation.problem.frequency_response import frequency_response
from seatrial.numerics.optimise import NormalEquations
from seatrial.physics.simulate.harmonics import Complex

_MAX_CONDITION = 1e10


@dataclass(frozen=True, eq=False)
class LineLeastSquares(FreeParameterProblem):
    """Unknowns: the free parameters of an affine model. It is a `LeastSquares` problem without local unknowns.

    Attributes:
        omega: (h,), rad/s, signed; forces: complex amplitudes of the model's inputs, (h, nu), its own signs.
        amplitudes: of the outputs as cosine and sine parts one after the other, (2 h, ny), SI.
        information: of those parts in units of each output's noise, (ny, 2 h, 2 h).
    """

    omega: Array
    forces: Complex
    outputs: tuple[str, ...]
    amplitudes: Array
    information: Array

    def _residuals(self, shared: Array) -> tuple[Array, Array]:
        """Model minus measured parts, (2 h, ny), and their derivatives, (q, 2 h, ny)."""
        found = frequency_response(self.model, self._parameter_values(shared), self.omega, self.outputs, self.free)
        motion = np.einsum("hyu,hu->hy", found.H, self.forces)
        slopes = np.einsum("qhyu,hu->qhy", found.dH, self.forces)
        parts = np.concatenate([motion.real, -motion.imag])
        return parts - self.amplitudes, np.concatenate([slopes.real, -slopes.imag], axis=1)

    def cost(self, shared: Array, local: Array) -> float:  # noqa: ARG002
        """Half the weighted sum of squares."""
        left = self._residuals(shared)[0]
        return 0.5 * float(np.einsum("ky,ykl,ly->", left, self.information, left))

    def normal(self, shared: Array, local: Array) -> NormalEquations:
        """The Gauss-Newton model at a point."""
        left, slopes = self._residuals(shared)
        weighted = np.einsum("ykl,qly->qky", self.information, slopes)
        gradient = np.einsum("qky,ky->q", weighted, left)
        hessian = np.einsum("qky,pky->qp", weighted, slopes)
        cost = 0.5 * float(np.einsum("ky,ykl,ly->", left, self.information, left))
        return NormalEquations(
            cost, gradient, hessian, local, np.zeros((*local.shape, 0)), np.zeros((0, len(shared), 0))
        )


def line_least_squares(
    model: Model,
    time: Array,
    motions: Array,
    outputs: tuple[str, ...],
    noise: Array,
    omega: Array,
    forces: Complex,
) -> LineLeastSquares:
    """The problem from motions (n, ny) that have settled, NaN where nothing was measured; a constant is taken out.

    Args:
        time: s; omega, forces: as in `LineLeastSquares`, phases of exp(i omega t).
        noise: standard deviation of each output, (ny,), SI.

    Raises:
        InputError: lines that the record is too short to tell apart.
    """
    angle = np.outer(time, omega)
    regressors = np.concatenate([np.cos(angle), np.sin(angle), np.ones((len(time), 1))], axis=1)
    parts, information = [], []
    for j in range(motions.shape[1]):
        good = np.isfinite(motions[:, j])
        gram = regressors[good].T @ regressors[good]
        if np.linalg.cond(gram) > _MAX_CONDITION:
            gap = float(np.min(np.diff(np.sort(np.abs(omega)))))
            raise InputError(
                f"a record of {time[-1] - time[0]:.4g} s does not tell apart lines met {gap:.2g} rad/s from one "
                f"another; record {2.0 * np.pi / max(gap, 1e-9):.3g} s, or fit the record itself"
            )
        parts.append(np.linalg.solve(gram, regressors[good].T @ motions[good, j])[:-1])
        others = gram[:-1, -1:] @ gram[-1:, :-1] / gram[-1, -1]
        information.append((gram[:-1, :-1] - others) / noise[j] ** 2)
    return LineLeastSquares(model, omega, forces, outputs, np.stack(parts, axis=1), np.stack(information))
