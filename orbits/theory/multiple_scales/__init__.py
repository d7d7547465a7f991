"""Multiple scales: the averaged coupled machine near resonance (slow manifolds, slow flow, steady states, response, decay).

All results are of first order in the mass ratio. A `SlowFlow` holds the parameters; the other functions take it as an argument.
"""

from ..manifolds import (
    ManifoldPoint,
    activation,
    friction_level,
    impact_loss,
    reversal_bound,
    sliding_bounds,
    squared_amplitude,
    symmetry_limit,
    turning_point,
    velocity_at,
)
from .backbone import Backbone, Coefficients, backbone, coefficients, resonance_detuning, resonance_frequency
from .clearance import BestClearance, TunedBackbone, best_clearance, tuned_backbone
from .continuation import SlowResponse
from .decay import damping_ratio, decay_amplitude, decay_bound, decay_rate, decay_time
from .equilibria import (
    Equilibrium,
    equilibria,
    equilibrium_at,
    impacting_polynomial,
    impacting_velocities,
    sliding_polynomial,
    sliding_turning_points,
)
from .flow import CLOSURES, SlowFlow
from .response import ResponseCurve, ResponsePoint, frequency_response, hopf_velocity, special_points
from .trajectory import SlowTrajectory, integrate

__all__ = [
    "CLOSURES",
    "Backbone",
    "BestClearance",
    "Coefficients",
    "Equilibrium",
    "ManifoldPoint",
    "ResponseCurve",
    "ResponsePoint",
    "SlowFlow",
    "SlowResponse",
    "SlowTrajectory",
    "TunedBackbone",
    "activation",
    "backbone",
    "best_clearance",
    "coefficients",
    "damping_ratio",
    "decay_amplitude",
    "decay_bound",
    "decay_rate",
    "decay_time",
    "equilibria",
    "equilibrium_at",
    "frequency_response",
    "friction_level",
    "hopf_velocity",
    "impact_loss",
    "impacting_polynomial",
    "impacting_velocities",
    "integrate",
    "resonance_detuning",
    "resonance_frequency",
    "reversal_bound",
    "sliding_bounds",
    "sliding_polynomial",
    "sliding_turning_points",
    "special_points",
    "squared_amplitude",
    "symmetry_limit",
    "tuned_backbone",
    "turning_point",
    "velocity_at",
]
