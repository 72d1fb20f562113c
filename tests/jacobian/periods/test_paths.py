"""Rules of quadrature for integrals along paths between branch points."""

from threading import Thread

from jacobian.numbers.long_reals import BallReals
from jacobian.periods.paths import legendre_rule


def test_nodes_wait_for_the_precision_of_another_thread():
    """flint has one precision for the whole process: the rule changed it while another thread computed with it."""
    made = Thread(target=legendre_rule.__wrapped__, args=(8,))
    with BallReals(53):
        made.start()
        made.join(0.2)
        assert made.is_alive()
    made.join(10)
    assert not made.is_alive()
