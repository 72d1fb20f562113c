"""The discrete Fourier transform of real samples on bare reals: interpreted floats and compiled double-doubles."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

from integrable import ChaplyginBall
from integrable.torus.loops import CompiledLoops, ReadableLoops
from jacobian.numbers.fourier import circle_of, half_spectrum

NOISE = (1e-15, 1e-15)
GRIDS = [(2, 2), (2, 16), (16, 2), (8, 8), (16, 64), (64, 16), (4, 256)]


@pytest.mark.parametrize("grid", GRIDS)
@pytest.mark.parametrize("multiple", [1, 4])
def test_floats_are_transformed_as_numpy_does(grid, multiple) -> None:
    rows, columns = grid
    samples = np.random.default_rng(1).normal(size=grid)
    room = [[0.0] * ((rows + 2) * columns) for _ in range(3)]
    circle = circle_of(multiple * max(grid))[:, 0].tolist()
    half_spectrum(samples.ravel().tolist(), grid, circle, *room)
    found = np.array(room[2]).view(complex).reshape(-1, columns)
    assert np.abs(found - np.fft.fft2(samples, norm="forward")[: rows // 2 + 1]).max() < 1e-15


@pytest.mark.parametrize("grid", GRIDS)
def test_double_doubles_are_transformed_to_their_last_digits(grid) -> None:
    generator = np.random.default_rng(2)
    samples = np.stack([generator.normal(size=grid), 1e-17 * generator.normal(size=grid)], axis=-1)
    values, _ = CompiledLoops().spectrum(samples, NOISE)
    (rows, columns), context = grid, mpmath.MPContext()
    context.prec = 160
    circle = [[context.expjpi(-context.mpf(2 * k) / n) for k in range(n)] for n in grid]
    exact = [[context.mpf(hi) + context.mpf(lo) for hi, lo in row] for row in samples.tolist()]
    for k, m in ((0, 0), (1, 1), (rows // 2, columns - 1), (rows // 2, columns // 2), (rows // 4, columns // 4)):
        total = context.fsum(
            exact[i][j] * circle[0][i * k % rows] * circle[1][j * m % columns]
            for i in range(rows)
            for j in range(columns)
        )
        x, y = (context.mpf(hi) + context.mpf(lo) for hi, lo in values[2 * (k * columns + m) :][:2].tolist())
        assert abs(context.mpc(x, y) - total / (rows * columns)) < 1e-31


def test_interpreted_loops_have_the_spectrum_of_compiled_ones() -> None:
    """To the digits of double-doubles, which long doubles lack on some machines."""
    ball = ChaplyginBall((1, 2, 3), 0.7)
    loops = ReadableLoops(ball.flow(ball.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))).setup)
    samples, grid = np.random.default_rng(3).normal(size=8 * 16).tolist(), (8, 16)
    (exact, sizes), quick = (x.spectrum(x.samples(x.row(samples), grid), NOISE) for x in (loops, CompiledLoops()))
    assert sizes == quick[1]
    count = 2 * 5 * 16
    with loops.reals:
        pairs = quick[0][:count].tolist()
        gaps = [abs(loops.reals.number(high) + low - x) for (high, low), x in zip(pairs, exact[:count], strict=True)]
    assert max(gaps) < 1e-31
