"""What an earlier result says of several coefficients together, as a term of the cost."""

import numpy as np

from seatrial.core.values import Parameters
from seatrial.data.trial.priors import JointPrior
from seatrial.estimation.estimate.online.marginal_prior import MarginalPrior
from seatrial.estimation.information.covariance import inverse


def joint_prior_term(parameters: Parameters, prior: JointPrior) -> MarginalPrior:
    """Return what the correlations add to the priors of each coefficient.

    1/2 d' (C^-1 - diag(C)^-1) d of the distance d from the mean: a Gaussian's exponent less those of its marginals.
    Together with the priors of each, which stay with the parameters, this is the Gaussian of covariance C.
    """
    indices = np.array([parameters.index(name) for name in prior.names], dtype=np.int64)
    added = inverse(prior.covariance) - np.diag(1.0 / np.diag(prior.covariance))
    return MarginalPrior(indices, prior.mean, added, np.zeros(len(indices)))
