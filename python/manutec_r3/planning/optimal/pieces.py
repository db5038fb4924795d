"""Motions as linear functions of few numbers: quartic pieces with continuous rates.

Normalised time s, from 0 to 1, is divided by a mesh. On a piece of length h, with x from 0 to 1,

    q(x) = cubic through the angles q and the slopes dq/ds at both ends + h^2 bend x^2 (1 - x)^2

Accelerations are a parabola on each piece, any one, and may jump from piece to piece as those under
limited torques do. These are the motions of Radau's collocation with three points, which prescribes
the acceleration there; angles and rates are continuous without a constraint.
"""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import polynomial

# Radau's points and weights of three stages, exact for integrals of degree 4.
RADAU_POINTS = np.array([(4.0 - 6.0**0.5) / 10.0, (4.0 + 6.0**0.5) / 10.0, 1.0])
RADAU_WEIGHTS = np.array([(16.0 - 6.0**0.5) / 36.0, (16.0 + 6.0**0.5) / 36.0, 1.0 / 9.0])

# Coefficients of x^0 to x^4 (columns) of what angle and slope at the beginning, angle and slope at
# the end, and the bend are multiplied with; slopes in x, not in s.
_SHAPES = np.array(
    [
        [1.0, 0.0, -3.0, 2.0, 0.0],
        [0.0, 1.0, -2.0, 1.0, 0.0],
        [0.0, 0.0, 3.0, -2.0, 0.0],
        [0.0, 0.0, -1.0, 1.0, 0.0],
        [0.0, 0.0, 1.0, -2.0, 1.0],
    ]
)


@dataclass(frozen=True)
class Points:
    """Where something is asked for.

    Attributes
    ----------
    piece : ndarray (n,) of int
        On which pieces.
    x : ndarray (n,)
        Where on them, from 0 to 1.
    """

    piece: np.ndarray
    x: np.ndarray

    @classmethod
    def on_all(cls, n_pieces: int, x: np.ndarray) -> "Points":
        """Return the same points on all pieces, piece by piece."""
        return cls(np.repeat(np.arange(n_pieces), len(x)), np.tile(x, n_pieces))

    def and_also(self, others: "Points") -> "Points":
        """Return these, then others."""
        return Points(np.append(self.piece, others.piece), np.append(self.x, others.x))


class Pieces:
    """Quartic pieces on a mesh.

    Their unknowns (3 N + 2, n_axes) are angles at the mesh points, slopes there, bends of the
    pieces, in this order.

    Parameters
    ----------
    mesh : ndarray (N + 1,)
        Normalised times from 0 to 1, ascending.
    """

    def __init__(self, mesh: np.ndarray) -> None:
        self.mesh = mesh
        self.length = np.diff(mesh)
        self.n = len(self.length)
        self.n_unknowns = 3 * self.n + 2
        # All coefficients (n, 5) of the unknowns, by what each unknown adds to them.
        self._coefficients = np.zeros((self.n, 5, self.n_unknowns))
        first = np.arange(self.n)
        slope = self.n + 1 + first
        bend = 2 * self.n + 2 + first
        one = np.ones(self.n)
        for shape, place, scale in zip(
            _SHAPES,
            (first, slope, first + 1, slope + 1, bend),
            (one, self.length, one, self.length, self.length**2),
            strict=True,
        ):
            self._coefficients[first, :, place] += np.multiply.outer(scale, shape)

    @property
    def ends(self) -> dict[str, list[int]]:
        """Which unknowns are the angles, and the slopes, at the beginning and at the end."""
        return {"angle": [0, self.n], "slope": [self.n + 1, 2 * self.n + 1]}

    def coefficients(self, unknowns: np.ndarray) -> np.ndarray:
        """Coefficients (N, 5, n_axes) of x^0 to x^4 of each piece."""
        return self._coefficients @ unknowns

    def values(self, points: Points, unknowns: np.ndarray, derivative: int) -> np.ndarray:
        """Angles or derivatives by s (n, n_axes) at n points."""
        coefficients = self.coefficients(unknowns)[points.piece]
        return np.einsum("nk,nka->na", self._powers(points, derivative), coefficients)

    def matrix(self, points: Points, derivative: int) -> np.ndarray:
        """Return (n, 3 N + 2): times unknowns, angles or derivatives by s at n points."""
        powers = self._powers(points, derivative)
        return np.einsum("nk,nku->nu", powers, self._coefficients[points.piece])

    def _powers(self, points: Points, derivative: int) -> np.ndarray:
        """Return derivatives by s of x^0 to x^4 (n, 5)."""
        powers = np.array([_monomial(k, points.x, derivative) for k in range(5)]).T
        return powers / self.length[points.piece, None] ** derivative

    def through(self, angle: np.ndarray, slope: np.ndarray, bend: np.ndarray) -> np.ndarray:
        """Unknowns from angles and slopes (N + 1, n_axes) at mesh points and bends (N, n_axes)."""
        return np.concatenate((angle, slope, bend))

    def halved(self, which: np.ndarray, unknowns: np.ndarray) -> tuple["Pieces", np.ndarray]:
        """Halve some pieces (N,) of bool; return the new ones and the same motion's unknowns."""
        middle = Points(np.flatnonzero(which), np.full(which.sum(), 0.5))
        n = self.n
        parts = unknowns[: n + 1], unknowns[n + 1 : 2 * n + 2], unknowns[2 * n + 2 :]
        at = middle.piece + 1
        angle = np.insert(parts[0], at, self.matrix(middle, 0) @ unknowns, axis=0)
        slope = np.insert(parts[1], at, self.matrix(middle, 1) @ unknowns, axis=0)
        # A bend is the coefficient of x^4 over the square of the length: a quarter for each half.
        bend = np.repeat(np.where(which[:, None], parts[2] / 4.0, parts[2]), 1 + which, axis=0)
        mesh = np.insert(self.mesh, at, (self.mesh[at - 1] + self.mesh[at]) / 2.0)
        pieces = Pieces(mesh)
        return pieces, pieces.through(angle, slope, bend)


def _monomial(power: int, x: np.ndarray, derivative: int) -> np.ndarray:
    """Return a derivative of x^power."""
    series = np.zeros(power + 1)
    series[power] = 1.0
    return polynomial.polyval(x, polynomial.polyder(series, derivative))
