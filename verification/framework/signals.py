"""Quantities from time histories."""
import numpy as np


def fit_frequency(times, values, guess, width=0.2):
    """Angular frequency of the oscillation nearest to `guess`: least squares of A cos + B sin + C
    under a Hann window, which suppresses other modes, by golden section within guess (1 -+
    width)."""
    weight = np.hanning(len(times) + 2)[1:-1]

    def misfit(omega):
        columns = np.stack([np.cos(omega * times), np.sin(omega * times), np.ones_like(times)], axis=1)
        coefficients = np.linalg.lstsq(columns * weight[:, None], values * weight, rcond=None)[0]
        return np.sum((weight * (values - columns @ coefficients))**2)

    return golden_section(misfit, guess * (1 - width), guess * (1 + width))


def tip_deflection(results, length=10):
    """Mean deflection u_z of the end x = `length` of a beam, by output time."""
    tip = results.nodes[:, 0] > length - 1e-9
    return np.array([results.nodal("displacement_z", step)[tip].mean() for step in range(len(results.times))])


def golden_section(function, low, high, tolerance=1e-10):
    """The minimum point of a function with one minimum between low and high."""
    ratio = (np.sqrt(5) - 1) / 2
    left, right = high - ratio * (high - low), low + ratio * (high - low)
    f_left, f_right = function(left), function(right)
    while high - low > tolerance * abs(high + low):
        if f_left < f_right:
            high, right, f_right = right, left, f_left
            left = high - ratio * (high - low)
            f_left = function(left)
        else:
            low, left, f_left = left, right, f_right
            right = low + ratio * (high - low)
            f_right = function(right)
    return (low + high) / 2
