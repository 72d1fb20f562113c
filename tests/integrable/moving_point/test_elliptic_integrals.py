"""The incomplete integral of the third kind compared with mpmath's."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

from integrable.moving_point.arithmetic import LongDoubles
from integrable.moving_point.elliptic_integrals import arctan_over, carlson_j

CONTEXT = mpmath.MPContext()
CONTEXT.dps = 40


def exact(x):
    high = float(x)
    return CONTEXT.mpf(high) + CONTEXT.mpf(float(x - high))


@pytest.mark.parametrize("kind", [np.float64, np.longdouble])
@pytest.mark.parametrize("modulus", ["small", "below 1", "above 1"])
def test_the_third_kind_to_its_last_digits(kind, modulus) -> None:
    """At cos²θ, cos²θ + k²sin²θ, 1, cos²θ + κ²sin²θ, as needed for a body with two equal moments; also one at a
    time.
    """
    generator, count = np.random.default_rng(4), 40
    angles = np.concatenate([generator.uniform(0, np.pi / 2, count), 10 ** generator.uniform(-6, -1, count)])
    k2 = {"small": 10 ** generator.uniform(-6, -1, 2 * count), "below 1": generator.uniform(0.5, 1, 2 * count),
          "above 1": 1 + 10 ** generator.uniform(-3, 1, 2 * count)}[modulus]  # fmt: skip
    s, c = np.sin(angles.astype(kind)), np.cos(angles.astype(kind))
    # (p − x)(p − y)(p − z) is not negative
    kappa2 = np.maximum(k2, 1) + 10 ** generator.uniform(-8, 1, 2 * count)
    x, y, z, p = c * c, c * c + k2 * s * s, 1 + 0 * s, c * c + kappa2 * s * s
    product = (p - x) * (p - y) * (p - z)
    # cases in which no difference has few digits: otherwise the rounded product would belong to other arguments
    chosen = (p - z) * (p - y) > 1e-4 * p * p
    x, y, z, p, product = (v[chosen] for v in (x, y, z, p, product))
    found = carlson_j(LongDoubles(kind), x, y, z, p, product)
    right = [CONTEXT.elliprj(*map(exact, row)) for row in zip(x, y, z, p, strict=True)]
    for one, other in zip(found, right, strict=True):
        assert abs(exact(one) / other - 1) < 8 * np.finfo(kind).eps
    for row, value in zip(zip(x, y, z, p, product, strict=True), found, strict=True):
        assert abs(carlson_j(LongDoubles(kind), *row) / value - 1) < 8 * np.finfo(kind).eps


def test_what_is_no_number_leaves_its_neighbours_alone() -> None:
    """The number of terms is chosen for the whole array: a NaN used to make it zero."""
    found = arctan_over(LongDoubles(float), np.array([0.0, 1e-6, np.nan, 1.0]))
    assert np.isnan(found[2])
    assert np.abs(found[[0, 1, 3]] - [1.0, np.arctan(1e-3) / 1e-3, np.pi / 4]).max() < 1e-15
