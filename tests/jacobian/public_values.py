"""One value of every public class of `jacobian`, over every kind of field, for the tests of values."""

from random import Random

from jacobian import CC, GF, MP, QQ, RR, HyperellipticCurve, poly
from jacobian.batch import DivisorArray
from jacobian.fields.residue import ResidueField
from jacobian.inexact.long_field import LongField
from jacobian.models.richelot import RichelotIsogeny, Splitting
from jacobian.models.standard import move_to_infinity
from jacobian.periods.abel import AbelMap
from jacobian.periods.abel_balls import AbelBalls
from jacobian.periods.kleinian import KleinianFunctions
from jacobian.periods.matrix import periods, real_periods
from jacobian.relatives.conic import representative
from jacobian.relatives.extended import ExtendedGroup, Lift, SecondKind
from jacobian.relatives.formal_sum import FormalSum, principal_divisor
from jacobian.relatives.glued import GeneralizedJacobian
from jacobian.relatives.kummer import kummer_surface
from jacobian.relatives.pseudo_group import PseudoGroup
from jacobian.relatives.ray_class import RayClassGroup
from jacobian.relatives.signed import SignedGroup

FIELDS = {
    "GF(p)": GF(101),
    "GF(p), a long p": GF(2**89 - 1),
    "GF(p^k), tables": GF(7, 2),
    "GF(p^2), digits": GF(2**31 - 1, 2),
    "GF(2^k), digits": GF(2, 20),
    "QQ": QQ,
    "RR": RR,
    "CC": CC,
    "MP": MP(30),
    "MP, complex": MP(30, complex=True),
}


def curve_over(K):
    """y² (+ xy + y) = x⁵ + 3x³ + 1."""
    return HyperellipticCurve(K, [1, 0, 0, 3, 0, 1], [1, 1] if K.characteristic == 2 else 0)


def values_over(K):
    """{description: value} for a field of FIELDS."""
    C = curve_over(K)
    J = C.jacobian()
    D = J.from_points([(0, 1)]) if K is QQ else J.random(Random(1))
    values = {
        "field": K,
        "curve": C,
        "group": J,
        "divisor": D,
        "zero": J.zero(),
        "array": DivisorArray.stack([D, J.zero()]),
        "table": J.fixed_base(D),
        **({"long numbers": LongField(100)} if K is RR else {}),
        "affine point": C.lift_x(0),
        "extended group": ExtendedGroup(K, C.f, [SecondKind(), Lift(K.zero)]) if K.characteristic != 2 else C,
        "point at infinity": C.points_at_infinity()[0],
    }
    if K.exact:
        rays = RayClassGroup(C)
        values |= {"ray class group": rays, "ray class": rays.lift(D), "fibre": rays.fibre}
        values["formal sum"] = FormalSum.from_divisor(D) - principal_divisor(C, [1, 1], [1])
    elif not getattr(K, "complex", K is CC):
        ovals = real_periods(HyperellipticCurve(K, [0, 4, 0, -5, 0, 1]))
        values |= {"Abel map": AbelMap(C), "periods": periods(C), "oval": ovals[0]}
        values["Kleinian functions"] = KleinianFunctions(AbelMap(C))
    if K is QQ:
        values |= {"Abel map in balls": AbelBalls(C, 10), "Kummer surface": kummer_surface(C)}
    if K.characteristic != 2:
        values["split curve"] = HyperellipticCurve(K, [1, 2, 0, 0, 0, 0, 1])
        values["split divisor"] = values["split curve"].jacobian().from_points([(0, 1)])
        quartic = HyperellipticCurve(K, [poly.integer(K, c) for c in (0, 6, 11, 6, 1)])
        pairs = SignedGroup(quartic, [0])
        # (x + 1)(x + 2), a part of f
        E = GeneralizedJacobian(quartic).from_mumford((2, 3, 1), (0, 0))
        values |= {"generalized group": E.jacobian, "generalized class": E, "signed group": pairs}
        values["signed divisor"] = pairs.twist((K.coerce(2), K.coerce(3), K.one), (K.zero, K.zero))
    if GF(101) == K:
        values |= {"pseudo group": PseudoGroup(C), "pencil": representative(D, C.lift_x(0)), "structure": J.structure()}
        quadratics = (1, 0, 1), (2, 0, 1), (3, 1, 1)
        source = HyperellipticCurve(K, poly.mul(K, poly.mul(K, *quadratics[:2]), quadratics[2]))
        phi = RichelotIsogeny(source, quadratics)
        even = HyperellipticCurve(K, [6, 0, 11, 0, 6, 0, 1])
        values |= {"isogeny": phi, "dual isogeny": phi.dual(), "isomorphism": move_to_infinity(C, C.lift_x(0))}
        values["splitting"] = Splitting(even, ((1, 0, 1), (2, 0, 1), (3, 0, 1)))
        values["residue field"] = ResidueField(K, (K.coerce(-2), K.zero, K.one))
    return values
