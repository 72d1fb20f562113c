"""All L-polynomials of a curve up to a bound, as a table."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from jacobian.arithmetic.residues import primes_up_to
from jacobian.arithmetic.saved import path_of
from jacobian.curve.curve import HyperellipticCurve
from jacobian.element import File
from jacobian.errors import ArgumentError, shown, whole
from jacobian.finite import weil

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True, eq=False)
class LPolynomials:
    """L_p(T) = 1 + a_1 T + … + a_g T^g + p·a_(g−1) T^(g+1) + … + p^g T^2g at all good primes p ≤ ``bound``.

    ``p``: (K,) int64, ascending; ``coefficients``: (K, g) int64, the a_1, …, a_g; ``bad``: the primes p up to the bound
    for which the equation is singular modulo p, or has p in a denominator. Another equation of the curve may be good
    there.
    """

    curve: HyperellipticCurve
    bound: int
    p: np.ndarray = field(repr=False)
    coefficients: np.ndarray = field(repr=False)
    bad: tuple[int, ...]

    def __len__(self) -> int:
        return len(self.p)

    def polynomial(self, p: int) -> list[int]:
        """L_p(T), ascending, of degree 2g; ArgumentError unless p is a prime of good reduction up to the bound."""
        wanted = whole(p, "p", f"a prime of good reduction up to {shown(self.bound)}")
        at = int(np.searchsorted(self.p, wanted))
        if at == len(self.p) or self.p[at] != wanted:
            why = "of bad reduction" if wanted in self.bad else f"no prime up to {shown(self.bound)}"
            raise ArgumentError(f"p = {shown(p)}: {why}; a prime of good reduction up to {shown(self.bound)} is needed")
        return weil.from_leading([1, *map(int, self.coefficients[at])], wanted)[::-1]

    def orders(self) -> list[int]:
        """#J(GF(p)) = L_p(1) for each p."""
        rows = zip(self.p.tolist(), self.coefficients.tolist(), strict=True)
        return [sum(weil.from_leading([1, *row], p)) for p, row in rows]

    def normalised(self) -> Any:
        """a_i/p^(i/2), (K, g) floats: the coefficients of L_p(T/√p). Their absolute values are at most C(2g, i)."""
        powers = np.arange(1, self.curve.genus + 1) / 2
        return self.coefficients / self.p[:, None].astype(float) ** powers

    def moments(self, most: int = 8) -> Any:
        """The means of (a_i/p^(i/2))^n, n = 0 … ``most``, for each i, (g, most + 1)."""
        most = whole(most, "most", "the largest exponent is an int, 1 … 40", 1, 40)
        values = self.normalised()
        return np.stack([np.mean(values**n, axis=0) for n in range(most + 1)], axis=1)

    def dirichlet_coefficients(self, euler: Mapping[int, Sequence[int]] | None = None) -> Any:
        """a_0 = 0, a_1, …, a_bound of Π 1/L_p(p^(−s)) = Σ a_n n^(−s), (bound + 1,) int64.

        ``euler``: the factors at bad primes, ascending, {2: [1, 1], …}; a bad prime that is not in it has the factor 1,
        as in the partial L-function, so that a_n = 0 for its multiples n.
        """
        factors = {p: [1, *row] for p, row in zip(self.p.tolist(), self.coefficients.tolist(), strict=True)}
        for p, factor in (euler or {}).items():
            if p not in self.bad:
                raise ArgumentError(
                    f"euler: {shown(p)} is no bad prime up to {shown(self.bound)}; those are {shown(self.bad)}"
                )
            factors[p] = [whole(c, f"euler[{p}]", "coefficients are ints") for c in factor]
        found = np.ones(self.bound + 1, np.int64)
        found[0] = 0
        for p in primes_up_to(self.bound).tolist():
            local = factors.get(p, [1]) if p in self.bad else weil.from_leading(factors[p], p)[::-1]
            series, power = [1], p
            while power <= self.bound:
                terms = range(1, min(len(local), len(series) + 1))
                series.append(-sum(local[i] * series[-i] for i in terms))
                power *= p
            exponents = np.zeros(self.bound // p, np.int64)
            for k in range(1, len(series) - 1):
                exponents[p**k - 1 :: p**k] += 1
            found[p::p] *= np.array(series[1:], np.int64)[exponents]
        return found

    # --- for other programs

    def columns(self) -> dict[str, Any]:
        """The dictionary of the columns: the array of the primes as "p", the arrays of the a_i as "a1", …, "ag"."""
        return {"p": self.p, **{f"a{i}": self.coefficients[:, i - 1] for i in range(1, self.curve.genus + 1)}}

    def to_pandas(self) -> pandas.DataFrame:
        """A table with the columns p, a1, …, ag; needs pandas (the extra io)."""
        return _needed("pandas").DataFrame(self.columns())

    def to_csv(self, path: File) -> None:
        """Writes a CSV file: a line of names, then one line p,a1,…,ag for each prime."""
        columns = self.columns()
        with path_of(path).open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(columns)
            writer.writerows(zip(*(column.tolist() for column in columns.values()), strict=True))

    def to_parquet(self, path: File) -> None:
        """Writes the :meth:`columns` as a Parquet file, with curve, bound and bad primes as its metadata; needs pyarrow
        (the extra io).
        """
        parquet, arrow = _needed("pyarrow.parquet"), _needed("pyarrow")
        said = {"curve": repr(self.curve), "bound": str(self.bound), "bad": " ".join(map(str, self.bad))}
        parquet.write_table(arrow.table(self.columns()).replace_schema_metadata(said), str(path_of(path)))

    def __repr__(self) -> str:
        return (
            f"L-polynomials of {self.curve!r} at {len(self.p)} primes up to {self.bound}; bad: "
            f"{', '.join(map(str, self.bad)) or 'none'}"
        )


def _needed(module: str) -> Any:
    from importlib import import_module

    try:
        return import_module(module)
    except ImportError:
        library = module.split(".")[0]
        raise ArgumentError(f"{library} is not installed: pip install 'jacobian-integrable[io]'") from None
