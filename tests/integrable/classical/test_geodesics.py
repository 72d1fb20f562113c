"""Geodesics on ellipsoids compared with GeographicLib, and the inverse problem."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from integrable.classical.ellipsoid import Ellipsoid
from integrable.classical.inverse import joining
from integrable.mumford.flow import Point
from jacobian import MP, RR
from jacobian.errors import ArgumentError
from tests.integrable.ways import constrained, forced

KARNEY = json.loads((Path(__file__).parents[2] / "data" / "geodesics.json").read_text("utf-8"))
EARTH = (40681077.7, 40680197.6, 40408308.7)  # squares of semi-axes, km²


def on_spheroid(c, a, b, lat, lon):
    """The point at geographic latitude and longitude in degrees, and unit vectors to the north and east."""
    (s, t), (u, v) = ((c.sin(x), c.cos(x)) for x in map(c.radians, (lat, lon)))
    n = a / c.sqrt(t**2 + (b / a * s) ** 2)
    return (n * t * v, n * t * u, n * (b / a) ** 2 * s), (-s * v, -s * u, t), (-u, v, c.zero)


@pytest.mark.parametrize("case", range(len(KARNEY["cases"])))
def test_lengths_and_directions_are_those_of_geographiclib(case):
    """Two axes with a relative difference of 1e-22 stand for the spheroid's equal ones. GeographicLib is right to 15
    nm, and its numbers here are floats, with steps of 1e-14 degrees.
    """
    K, given = MP(30), KARNEY["cases"][case]
    c = K.context
    a = c.mpf(KARNEY["semi-major axis, m"])
    b = a - a / c.mpf(KARNEY["flattening"].removeprefix("1/"))
    earth = Ellipsoid((a * a * (1 + c.mpf(10) ** -22), a * a, b * b), K)
    q, north, east = on_spheroid(c, a, b, given["lat1"], given["lon1"])
    azimuth = c.radians(given["azi1"])
    p = tuple(c.cos(azimuth) * x + c.sin(azimuth) * y for x, y in zip(north, east, strict=True))
    path = earth.flow(constrained(earth, Point(q, p))).at([given["s12"]])
    end, north, east = on_spheroid(c, a, b, given["lat2"], given["lon2"])
    assert max(abs(x - y) for x, y in zip(path.q[0], end, strict=True)) < 2e-8
    turned = c.degrees(c.atan2(K.dot(path.p[0], east), K.dot(path.p[0], north)))
    assert abs((turned - given["azi2"] + 180) % 360 - 180) < 1e-11


def departing(earth, rng, length):
    """A state with |p| = length at a random point in a random direction, and its position at time 1."""
    a = np.array([float(x) for x in earth.constants])
    q, p = rng.normal(size=len(a)), rng.normal(size=len(a))
    q /= np.sqrt((q * q / a).sum())
    p -= q / a * (p @ (q / a)) / ((q / a) @ (q / a))
    K = earth.field
    state = Point(*(tuple(map(K.coerce, v)) for v in (q.tolist(), (p * length / np.linalg.norm(p)).tolist())))
    state = constrained(earth, state)
    return state, earth.flow(state).at([K.one]).q[0]


@pytest.mark.parametrize(
    ("length", "field"),
    [
        (1.0, RR),
        (3000.0, RR),
        pytest.param(15000.0, RR, marks=pytest.mark.slow),
        pytest.param(9000.0, MP(30), marks=pytest.mark.slow),
    ],
)
def test_on_the_triaxial_earth_the_inverse_problem_undoes_the_direct_one(length, field):
    earth = Ellipsoid(EARTH, field)
    state, end = departing(earth, np.random.default_rng(int(length)), length)
    found = joining(earth, state.q, end)
    assert max(abs(x - y) for x, y in zip(found.p, state.p, strict=True)) < 1e5 * field.eps * 6400


@pytest.mark.parametrize("a", [(1, 4), pytest.param((1, 2, 3, 5), marks=pytest.mark.slow)])
def test_it_does_so_in_other_dimensions(a):
    ellipsoid = Ellipsoid(a)
    state, end = departing(ellipsoid, np.random.default_rng(3), 1.0)
    assert np.abs(np.subtract(joining(ellipsoid, state.q, end).p, state.p)).max() < 1e-13


def test_what_is_no_problem_is_refused_by_name():
    earth = Ellipsoid((1, 2, 3))
    with pytest.raises(ArgumentError, match=r"first = \(1, 1, 1\): 3 numbers, a point of the ellipsoid, is needed"):
        joining(earth, (1, 1, 1), (1, 0, 0))
    with pytest.raises(ArgumentError, match=r"last = \(1, 0\): 3 numbers"):
        joining(earth, (1, 0, 0), (1, 0))
    with pytest.raises(ArgumentError, match="another point than first"):
        joining(earth, (1, 0, 0), (1, 0, 0))


def test_opposite_points_have_a_geodesic_too():
    earth = Ellipsoid((1, 2, 3))
    found = joining(earth, (1, 0, 0), (-1, 0, 0))
    assert np.abs(earth.flow(found).at([1]).q[0] - [-1, 0, 0]).max() < 1e-14


def test_where_newton_steps_for_a_length_alternate_it_is_found():
    """Newton's steps from either side of the target used to lead almost to the previous point."""
    ellipsoid = Ellipsoid((0.08855663757593155, 0.21011479187620866, 1.5013137880610699))
    start = Point(
        (0.04796929684369781, 0.1892632198743626, -1.0983434383294137),
        (-0.05438119773160505, 0.6490152892810466, 0.7588292559019554),
    )
    path = ellipsoid.flow(start).at([-3.83])
    back = ellipsoid.flow(Point(tuple(path.q[0].tolist()), tuple(path.p[0].tolist()))).at([3.83])
    assert np.abs(np.ravel(start) - np.hstack([back.q[0], back.p[0]])).max() < 1e-13


SLOW = [
    # doubled steps overshot by almost as much every time, which led to a refusal after minutes
    (
        (0.46572207114444303, 0.034994824104107335, 0.18009290735929562),
        (0.15086287286409777, -0.15091748830616616, 0.23255084485618627),
        (0.012438332353369573, -0.0027110536602145806, -0.01217455186570281),
        29.9,
    ),
    # where dt/dτ is a thirtieth of its mean, steps always fell short, which led to a refusal
    (
        (0.0009296452510845072, 0.0011492904447045111, 3.2941629829952653e-06, 0.0003276980146131546),
        (-0.0006240848224694259, 0.01926754331469173, -0.0010297446746154223, 0.010780769773115172),
        (-25.133580151910053, -12.395101618669456, -7.47277282959057, -65.20167384398502),
        0.007883096783573313,
    ),
]


@pytest.mark.parametrize(("squares", "q", "p", "time"), SLOW)
def test_lengths_that_steps_by_rates_did_not_find(squares, q, p, time):
    ellipsoid = Ellipsoid(squares)
    start = ellipsoid.state(q, p)
    path = ellipsoid.flow(start).at([-time])
    back = ellipsoid.flow(Point(tuple(path.q[0].tolist()), tuple(path.p[0].tolist()))).at([time])
    size = np.repeat([max(map(abs, part)) for part in start], len(q))
    assert (np.abs(np.ravel(start) - np.hstack([back.q[0], back.p[0]])) / size).max() < 1e-11


@pytest.mark.parametrize("length", [1e-7, 3e-9])
def test_short_geodesics_are_found_to_all_digits_and_enclosed(length):
    """The first Newton step is small there, and was mistaken for the last one."""
    ellipsoid = Ellipsoid((1, 2, 3))
    flow = ellipsoid.flow(ellipsoid.state((1, 0, 0), (0, 1, 0)))
    rough, fine = (flow._motion.tau_at(length, digits, flow._clock) for digits in (20, 40))
    assert abs(rough - fine) < 1e-19 * abs(fine)
    assert flow.enclosure([length]).radius[0] <= 1e-15


# found by tests.fuzz systems --seed 20261128 (kind "far ellipsoid", cases 1056 and 2776), and an ordinary geodesic of
# genus 6, which additions refused. In genus ≥ 3 a short translation along (1, 0, …) has pairs of nearly opposite
# points, and their sums lost hundreds of bits. Each sum also multiplied the distance of a lift from √U(e)
HIGH = [
    (
        (50.18451992832398, 606.0440147350414, 18.36201608409908, 110.23846642976197, 902.097118820239),
        (0.9677081389088577, 0.0, -2.871584967611813, -3.434516059947503, -19.586298090718667),
        (-16.64112462650171, -3.9271830790359776, 17.073115519485253, -86.07166784587766, -14.24637603522183),
        (-300.43144794048715, 86587.95110034801),
    ),
    (
        (7.549015124122469, 1217.7834115682572, 1.4913391983497433, 1.5242713061048445, 0.08920146742027844),
        (1.5036930373025168, 12.308288211803747, -0.8217916524889156, 0.3939754835738728, -0.04369581354288206),
        (9.215443459463337, 0.4676004806111075, 88.82996240572501, 139.31010679991914, -22.66288402432342),
        (1571.3647565757253,),
    ),
    (
        (1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0),
        (0.3, 0.5, -0.6, 0.5, -0.7, 0.8, 0.7),
        (1.0, -0.5, 0.25, 0.5, 0.75, -0.25, 0.5),
        (-2.5,),
    ),
]


@pytest.mark.thinned(2)
@pytest.mark.parametrize(("squares", "q", "p", "times"), HIGH)
def test_additions_reach_the_times_of_a_geodesic_in_many_dimensions(squares, q, p, times):
    a, q, p = map(np.array, (squares, q, p))
    q /= np.sqrt((q * q / a).sum())
    p -= (q / a) * (p @ (q / a)) / ((q / a) @ (q / a))
    system = Ellipsoid(squares)
    flow = system.flow(system.state(tuple(q), tuple(p)))
    # series of the equations of motion reach the last time; the torus of genus 6 takes ten times as long
    other = forced(flow, "torus").at(times) if len(squares) < 7 else flow.at(times)
    found = forced(flow, "additions").at(times)
    for x, y in ((found.q, other.q), (found.p, other.p)):
        assert abs(x - y).max() < 4e-15 * abs(y).max()
