"""Discrete logarithms: baby steps and giant steps (Shanks 1971), kangaroos (Pollard 1978, with the distinguished points
of van Oorschot and Wiener 1999), and the reduction to prime orders (Pohlig and Hellman 1978).
"""

from __future__ import annotations

from collections.abc import Iterable
from math import isqrt
from random import Random
from typing import Any

from jacobian.element import Rng
from jacobian.errors import ArgumentError, Infeasible, NotAMultiple, shown
from jacobian.fields.randomness import random_below
from jacobian.finite.integers import factorization
from jacobian.finite.orders import reduce_order
from jacobian.law.divisor import Divisor, check_scalar

BABY_STEPS_WIDTH = 1 << 32
KANGAROO_WIDTH = 1 << 48


def discrete_log(
    base: Divisor,
    target: Divisor,
    *,
    order: int | None = None,
    primes: Iterable[int] | None = None,
    interval: tuple[int, int] | None = None,
    rng: Rng | None = None,
) -> int:
    """An m with m·base = target, two classes of one group; NotAMultiple if there is none.

    With ``interval`` = (low, high) an m in low … high is searched for by baby steps and giant steps up to a width of
    2^32, by kangaroos up to 2^48; no order is needed. Without an interval, m is the least non-negative one, found one
    prime at a time. ``order``: a multiple of the order of ``base``, by default #J; ``primes``: its prime factors, by
    default computed. Infeasible for a prime factor or an interval above 2^48. ``rng`` seeds the kangaroos.
    """
    if interval is not None:
        return _in_interval(base, target, *_check_interval(interval), rng)
    multiple = base.jacobian.order() if order is None else abs(check_scalar(order, "order"))
    if multiple == 0 or multiple * base:
        raise ArgumentError(f"order = {shown(order)}: a non-zero multiple of the order of base = {base} is needed")
    return pohlig_hellman(base, target, factorization(multiple, primes), rng)


def _check_interval(interval: Any) -> tuple[int, int]:
    try:
        low, high = map(check_scalar, interval)
    except Exception:
        raise ArgumentError(f"interval = {shown(interval)}: a pair of ints (low, high) is needed") from None
    if low > high:
        raise ArgumentError(f"interval = ({shown(low)}, {shown(high)}) is empty: low ≤ high is needed")
    return low, high


def pohlig_hellman(base: Divisor, target: Divisor, factors: dict[int, int], rng: Rng | None = None) -> int:
    """The least m ≥ 0 with m·base = target, from a factored multiple of the order of base."""
    order = reduce_order(base, factors)
    if order * target:
        raise NotAMultiple(f"target = {target} is no multiple of base = {base}: its order does not divide {order}")
    result, modulus = 0, 1
    for prime in factors:
        power = 1
        while order % (power * prime) == 0:
            power *= prime
        digits = _prime_power_log(order // power * base, order // power * target, prime, power, rng)
        result += modulus * ((digits - result) * pow(modulus, -1, power) % power)
        modulus *= power
    return result


def _prime_power_log(base: Divisor, target: Divisor, prime: int, power: int, rng: Rng | None) -> int:
    """The logarithm m modulo ``power``, the order of base, found digit by digit to the base ``prime``."""
    result, place = 0, 1
    socle = power // prime * base
    while place < power:
        rest = power // (place * prime) * (target - result * base)
        result += place * _in_interval(socle, rest, 0, prime - 1, rng)
        place *= prime
    return result


def _in_interval(base: Divisor, target: Divisor, low: int, high: int, rng: Rng | None) -> int:
    if high - low < BABY_STEPS_WIDTH:
        found = baby_step_giant_step(base, target, low, high)
    elif high - low < KANGAROO_WIDTH:
        found = kangaroo(base, target, low, high, rng)
    else:
        raise Infeasible(
            f"a discrete logarithm in an interval of {shown(high - low + 1)}: kangaroos are sent over 2^48 at most"
        )
    if found is None:
        raise NotAMultiple(
            f"target = {target} is no multiple m·base with {shown(low)} ≤ m ≤ {shown(high)}, base = {base}"
        )
    return found


def baby_step_giant_step(base: Divisor, target: Divisor, low: int, high: int) -> int | None:
    """The least m in low … high with m·base = target, or None: about 2√(high − low) additions, with half as many
    classes stored.
    """
    step = isqrt(high - low) + 1
    table: dict[Divisor, int] = {}
    baby = base.jacobian.zero()
    for i in range(step):
        if baby in table:
            break  # i is the order of base, and the table contains all its multiples
        table[baby] = i
        baby = baby + base
    rest, giant = target - low * base, -step * base
    for m in range(low, high + 1, step):
        found = table.get(rest)
        if found is not None:
            return m + found if m + found <= high else None
        rest = rest + giant
    return None


def kangaroo(base: Divisor, target: Divisor, low: int, high: int, rng: Rng | None = None) -> int | None:
    """An m in low … high with m·base = target, found by about 2√(high − low) additions with little memory.

    None when eight pairs of kangaroos have not met, each after twenty times the expected number of jumps: the target is
    then outside the interval, except with a chance below 1e-6. By default ``rng`` has a fixed seed.
    """
    rng = Random(0) if rng is None else rng
    width = high - low + 1
    for _ in range(8):
        found = _hunt(base, target, low, width, rng)
        if found is not None:
            return found
    return None


def _hunt(base: Divisor, target: Divisor, low: int, width: int, rng: Rng) -> int | None:
    mean = isqrt(width) // 2 + 1
    lengths = [1 + random_below(rng, 2 * mean) for _ in range(32)]
    jumps = [length * base for length in lengths]
    # one class in √width/64 to √width/32 is distinguished, so about 100 of the 2√width visited classes become traps
    mask = (1 << max(0, mean.bit_length() - 5)) - 1
    start = low + width // 2 + random_below(rng, mean)
    positions, distances = [start * base, target], [start, 0]
    traps: dict[Divisor, tuple[int, int]] = {}
    for _ in range(20 * (2 * mean + 32 * (mask + 1))):
        for who in (0, 1):
            place, distance = positions[who], distances[who]
            number = hash(place)
            if not number & mask:
                owner, other = traps.setdefault(place, (who, distance))
                if owner != who:
                    m = distance - other if who == 0 else other - distance
                    if low <= m < low + width:
                        return m
            jump = (number >> 20) % 32
            positions[who], distances[who] = place + jumps[jump], distance + lengths[jump]
    return None
