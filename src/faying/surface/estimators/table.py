"""All estimators by name: a new one is its file and its name in this list."""

from faying.surface.estimators import box, fpenn, higuchi, mfdfa, moments, psd, roughness_length, structure
from faying.surface.estimators.base import Estimator

ESTIMATORS: dict[str, Estimator] = {
    module.ESTIMATOR.name: module.ESTIMATOR
    for module in (psd, structure, roughness_length, box, higuchi, mfdfa, moments, fpenn)
}
METHODS = tuple(ESTIMATORS)
