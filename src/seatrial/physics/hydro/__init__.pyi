"""Names of this package, imported when first used."""

from seatrial.physics.hydro.capytaine_data import HullData as HullData, HullExcitation as HullExcitation
from seatrial.physics.hydro.capytaine_data import hull_data as hull_data, read_capytaine as read_capytaine
from seatrial.physics.hydro.excitation import G as G, group_velocity as group_velocity, wavenumber as wavenumber
from seatrial.physics.hydro.empirical import EmpiricalEstimate as EmpiricalEstimate, HullForm as HullForm
from seatrial.physics.hydro.empirical import added_mass as added_mass, clarke as clarke
from seatrial.physics.hydro.empirical import cross_flow_coefficients as cross_flow_coefficients
from seatrial.physics.hydro.empirical import interaction_coefficients as interaction_coefficients, kijima as kijima
from seatrial.physics.hydro.empirical import yoshimura as yoshimura
from seatrial.physics.hydro.excitation import BoxHull as BoxHull, Complex as Complex, Excitation as Excitation
from seatrial.physics.hydro.excitation import encounter_frequency as encounter_frequency
from seatrial.physics.hydro.tabulated import coefficients_at_speed as coefficients_at_speed
from seatrial.physics.hydro.tabulated import excitation_at_speed as excitation_at_speed
from seatrial.physics.hydro.tabulated import WaveTable as WaveTable
from seatrial.physics.hydro.tabulated import TabulatedExcitation as TabulatedExcitation
from seatrial.physics.hydro.tabulated import read_transfer as read_transfer
from seatrial.physics.hydro.section import MOTIONS as MOTIONS, LewisForm as LewisForm
from seatrial.physics.hydro.section import SectionMotion as SectionMotion, haskind_damping as haskind_damping
from seatrial.physics.hydro.section import section_hydrodynamics as section_hydrodynamics
