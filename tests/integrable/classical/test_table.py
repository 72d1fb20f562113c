"""Which test checks which property of which system: every cell of the table names an existing test."""

from importlib import import_module

import pytest

from tests.integrable.classical.rows import CASES, EXACT

FLOWS, EXACTLY, LINE, WAVES = "test_flows", "test_identities", "test_kowalevski", "test_kdv"
STARS = "test_kuzmin_kutuzov"
EVERYWHERE = {
    "exact over GF(2^61 − 1) and GF(7^3)": (EXACTLY, "test_the_vector_field_is_a_mumford_field"),
    "30 digits and signs beside an integration": (FLOWS, "test_thirty_digits_against_an_integration"),
    "30 digits after some periods": (FLOWS, "test_thirty_digits_after_some_periods"),
    "floats at 10^6 beside 40 digits": (FLOWS, "test_floats_against_forty_digits"),
    "integrals, group property, reversal": (FLOWS, "test_group_property_reversal_and_integrals"),
    "bad input by name": (FLOWS, "test_bad_input_is_named"),
}
"""For every system of ``CASES``."""
PLACES = ("coordinate planes and branch points", "coinciding points", "relative equilibria", "separatrices")
BODIES = "tests.integrable.test_special_positions"
BODY = [
    (BODIES, "test_a_vanishing_gamma"),
    (BODIES, "test_equal_roots_of_U"),
    (BODIES, "test_permanent_rotations"),
    (BODIES, "test_the_separatrix"),
]
COINCIDING, POTENTIALS = (
    "test_both_points_of_a_pair_at_one_branch_point",
    "test_special_positions_in_quartic_and_cubic_potentials",
)
# in genus 1 there is only one point
AXIS = [(FLOWS, "test_special_positions_of_axes"), None, *2 * [(FLOWS, "test_special_positions_of_axes")]]
QUADRIC = [(FLOWS, POTENTIALS), (FLOWS, COINCIDING), *2 * [(FLOWS, POTENTIALS)]]
SPECIAL = {
    "ball": BODY,
    # an axis with a barrier is not crossed, and its a_i is no branch point; no other position is special
    "barriers": [None, None, (FLOWS, POTENTIALS), None],
    "ellipsoid": [
        (FLOWS, "test_geodesics_from_the_ends_of_axes"),
        (FLOWS, COINCIDING),
        (FLOWS, "test_a_coordinate_ellipse_closes"),
        (FLOWS, COINCIDING),
    ],
    "galaxy": [
        (STARS, "test_stars_in_planes_and_on_the_axis"),
        (STARS, "test_a_star_at_a_focus"),
        (STARS, "test_circles_and_rest"),
        (STARS, "test_a_star_at_a_focus"),
    ],
    "garnier": QUADRIC,
    "henon_heiles": QUADRIC,
    "lagrange": AXIS,
    "neumann": [
        (FLOWS, "test_special_positions_of_neumann"),
        (FLOWS, COINCIDING),
        *2 * [(FLOWS, "test_special_positions_of_neumann")],
    ],
    "pendulum": AXIS,
    # its ovals are gaps, which never meet but may close
    "toda": [
        (FLOWS, "test_a_lattice_with_closed_gaps"),
        None,
        (FLOWS, "test_the_lattice_at_rest_stays"),
        None,
    ],
    "top": BODY,
    # its gaps stay apart, and closed ones are solitons, which belong to kdv
    "two_gaps": [(WAVES, "test_a_wave_at_one_place_from_the_edges_of_its_gaps"), None, None, None],
    "veselova": [
        (FLOWS, "test_special_positions_of_veselova"),
        (FLOWS, COINCIDING),
        *2 * [(FLOWS, "test_special_positions_of_veselova")],
    ],
}
OTHERS = {
    # there is a map from a state to its divisors, but no inverse
    "kowalevski": [
        (EXACTLY, "test_the_vector_field_is_a_mumford_field"),
        (LINE, "test_divisors_run_along_a_straight_line"),
        (LINE, "test_floats_are_right_far_away"),
        (LINE, "test_what_is_not_there_is_refused"),
    ],
    "kdv": [
        (WAVES, "test_the_equation_exactly"),
        (WAVES, "test_thirty_digits_against_an_integration"),
        (WAVES, "test_thirty_digits_at_ten_periods"),
        (WAVES, "test_floats_against_forty_digits_far_away"),
        (WAVES, "test_reversal_shape_and_bounds"),
        (WAVES, "test_closed_gaps_and_bands_leave_no_trace"),
        (WAVES, "test_bad_input_is_named"),
    ],
}


def test_every_system_is_in_the_table() -> None:
    names = {name for name, _ in CASES}
    assert set(SPECIAL) == names
    assert names | {"kowalevski"} == set(EXACT)
    assert all(len(tests) == len(PLACES) for tests in SPECIAL.values())


@pytest.mark.parametrize("name", [*SPECIAL, *OTHERS])
def test_the_tests_of_the_table_are_there(name) -> None:
    tests = [*EVERYWHERE.values(), *SPECIAL[name]] if name in SPECIAL else OTHERS[name]
    for module, test in filter(None, tests):
        home = module if "." in module else f"tests.integrable.classical.{module}"
        assert callable(getattr(import_module(home), test))
