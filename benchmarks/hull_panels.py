"""Hull panels, parametric or from a file, to hydrodynamic data by the panel code Capytaine (extra `hydro`)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from seatrial.core.values import Array, Index, InputError
from seatrial.physics.hydro.capytaine_data import DOFS, HullData, hull_data
from seatrial.physics.hydro.excitation import G

if TYPE_CHECKING:
    import xarray as xr

MISSING_CAPYTAINE = (
    "computing hydrodynamic data needs the panel code Capytaine; install it with: pip install 'seatrial[hydro]'"
)


@dataclass(frozen=True)
class HullPanels:
    """The wetted hull at rest: vertices (v, 3) in m, x forward from midship, y to port, z up from the water line.

    `faces` (f, 4) holds indices of vertices, counterclockwise seen from the water.
    """

    vertices: Array
    faces: Index


def wigley(L: float, B: float, T: float, *, along: int = 40, down: int = 8) -> HullPanels:
    """The parabolic hull of Wigley 1942: y = B / 2 (1 - (2 x / L)^2) (1 - (z / T)^2).

    Block coefficient 4/9, waterplane coefficient 2/3; `along` by `down` panels a side.

    Raises:
        InputError: a dimension is not positive or there are fewer than 4 by 2 panels.
    """
    half = _positive(B, "B") / 2
    return hull_from_sections(L, T, lambda x, z: half * (1 - x**2) * (1 - z**2), along, down)


def hull_from_sections(
    L: float, T: float, half_breadth: Callable[[Array, Array], Array], along: int, down: int
) -> HullPanels:
    """Panels of the hull y = half_breadth(2 x / L, z / T) [m], closed at stem, stern and keel.

    Args:
        L, T: length and draught, m.
        half_breadth: function of arrays, -1 to 1 (stern to stem) and -1 to 0 (keel to water line).
        along, down: panels a side.

    Raises:
        InputError: a dimension is not positive, fewer than 4 by 2 panels, or a half breadth that is negative or NaN.
    """
    _positive(L, "L")
    _positive(T, "T")
    if along < 4 or down < 2:
        raise InputError(f"a hull needs at least 4 by 2 panels a side, not {along} by {down}")
    x = np.linspace(-1.0, 1.0, along + 1)
    z = -np.sin(np.linspace(np.pi / 2, 0.0, down + 1))
    X, Z = np.meshgrid(x, z, indexing="ij")
    Y = np.asarray(half_breadth(X, Z), dtype=np.float64)
    if not np.all(np.isfinite(Y)) or np.any(Y < -1e-12) or not np.any(Y > 0):
        raise InputError("the half breadth of the hull must be finite and not negative, and somewhere positive")
    port = np.stack([X * L / 2, Y, Z * T], axis=-1).reshape(-1, 3)
    corner = (np.arange(along)[:, None] * (down + 1) + np.arange(down)).ravel()
    quads = np.column_stack([corner, corner + 1, corner + down + 2, corner + down + 1])
    starboard = port * np.array([1.0, -1.0, 1.0])
    faces = np.vstack([quads, quads[:, ::-1] + len(port)]).astype(np.int64)
    return HullPanels(np.vstack([port, starboard]), faces)


def solve_hull(
    hull: HullPanels | str | Path,
    omega: Array,
    headings: Array,
    *,
    depth: float = np.inf,
    rho: float = 1025.0,
    centre_of_mass: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> HullData:
    """Hydrodynamic data of a hull at rest; arguments and errors as `capytaine_dataset`."""
    return hull_data(capytaine_dataset(hull, omega, headings, depth=depth, rho=rho, centre_of_mass=centre_of_mass))


def capytaine_dataset(
    hull: HullPanels | str | Path,
    omega: Array,
    headings: Array,
    *,
    depth: float = np.inf,
    rho: float = 1025.0,
    centre_of_mass: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> xr.Dataset:
    """Solve radiation and diffraction of heave and pitch about midship with Capytaine, at zero speed.

    Args:
        hull: panels, or a mesh file in a format that Capytaine reads (what stands above the water is cut off).
        omega: rad/s (n,); in deep water the limit at infinity is solved for radiation besides.
        headings: rad (h,), 0 following, pi head.
        depth: of the water, m.
        rho: density, kg/m^3.
        centre_of_mass: m, from midship and water line; it enters the stiffness of pitch.

    Raises:
        InputError: Capytaine is not installed, a frequency, depth or density is out of sense, no such mesh file, or
            panels too coarse for the highest frequency.
    """
    try:
        import capytaine as cpt  # pyright: ignore[reportMissingImports]
        import xarray as xr
    except ImportError:
        raise InputError(MISSING_CAPYTAINE) from None
    w = np.asarray(omega, dtype=np.float64)
    if w.ndim != 1 or w.size < 2 or not np.all(np.isfinite(w) & (w > 0.0)):
        raise InputError("hydrodynamic data need at least two positive, finite frequencies [rad/s]")
    _positive(depth, "depth", finite=False)
    _positive(rho, "rho")
    cpt.set_logging("ERROR")
    body = _body(hull, centre_of_mass)
    _refuse_coarse_mesh(body, float(w.max()))
    # the Prony decomposition in Python starts from random numbers; the one in Fortran gives the same every time
    green = cpt.Delhommeau(finite_depth_prony_decomposition_method="fortran")
    solver = cpt.BEMSolver(green_function=green)
    shared = {"rho": rho, "water_depth": depth, "radiating_dof": DOFS}
    directions = np.unique(np.asarray(headings, dtype=np.float64))
    waves = xr.Dataset(coords={"omega": np.unique(w), "wave_direction": directions, **shared})
    solved = solver.fill_dataset(waves, body, n_jobs=1, hydrostatics=True, progress_bar=False)
    if np.isfinite(depth):
        return solved
    limit = xr.Dataset(coords={"omega": [np.inf], **shared})
    infinite = solver.fill_dataset(limit, body, n_jobs=1, hydrostatics=False, progress_bar=False)
    extra = infinite[["added_mass", "radiation_damping"]]
    everywhere = [key for key in solved.data_vars if "omega" not in solved[key].dims]
    joined = xr.concat([solved.drop_vars(everywhere), extra], dim="omega", coords="minimal", compat="override")
    return joined.merge(solved[everywhere], compat="override")


def _body(hull: HullPanels | str | Path, centre_of_mass: tuple[float, float, float]) -> Any:
    """The floating body with heave, pitch and a lid against irregular frequencies."""
    import capytaine as cpt  # pyright: ignore[reportMissingImports]

    if isinstance(hull, HullPanels):
        mesh = cpt.Mesh(hull.vertices, hull.faces, name="hull")
    else:
        if not Path(hull).is_file():
            raise InputError(f"there is no mesh file {hull}")
        mesh = cpt.load_mesh(str(hull))
    mesh = mesh.immersed_part()
    return cpt.FloatingBody(
        mesh,
        dofs=cpt.rigid_body_dofs(only=DOFS, rotation_center=(0.0, 0.0, 0.0)),
        lid_mesh=mesh.generate_lid(),
        center_of_mass=centre_of_mass,
        name="hull",
    )


def _refuse_coarse_mesh(body: Any, omega: float) -> None:
    """Raise InputError beyond the shortest wave that Capytaine vouches for, eight of the largest panel radius."""
    highest = float(np.sqrt(2 * np.pi * G / body.minimal_computable_wavelength))
    if omega > highest:
        raise InputError(
            f"the panels are too coarse for {omega:g} rad/s; they are good for {highest:.3g} rad/s, so refine the mesh "
            "or leave out higher frequencies"
        )


def _positive(value: float, name: str, *, finite: bool = True) -> float:
    if not value > 0.0 or (finite and not np.isfinite(value)):
        raise InputError(f"{name} must be positive{' and finite' if finite else ''}, not {value:g}")
    return value
