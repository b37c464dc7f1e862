"""Check a roberval certificate: `python check_certificate.py certificate.json`.

This file stands alone: plain Python, whole numbers only, no code shared with roberval. It builds a
model of its own, the energies of all links: be it about d, d0 or h, parameters have no effect
together exactly when they add a constant to the energy (Gautier 1991, eq. (11)). At random states,
modulo each prime and with 768 binary digits, the base columns must be independent (modulo a prime a
proof), leave nothing of any other column, and give beta, exactly or as the nearest double. Modulo a
prime, powers of random rotations stand for multiples of units of angle, exactly if the only one is
a number (Lindemann). The SHA-256 guards all else. Exit code: 0 accepted, 1 refused, 2 unreadable.
"""

# ruff: noqa: B905, D102, D103, E731
import ast
import hashlib
import json
import random
import sys
from collections.abc import Callable
from fractions import Fraction
from functools import partial, reduce
from math import isqrt, lcm, prod
from pathlib import Path
from typing import Any

BITS = 768  # binary digits behind the point
FRESH = 3  # samples that must add nothing before the rank counts as reached
KINDS = ["XX", "XY", "XZ", "YY", "YZ", "ZZ", "MX", "MY", "MZ", "M", "Ia"]
KEYS = """angle_order base beta changes degree failure_log2 format generic model no_effect order
primes rank regrouped robot robot_sha256 rounding_error samples seeds sha256 version witnesses"""
Vector = list[int]
Rotation = tuple[int, int]  # cosine and sine
Op = Callable[..., Any]
canonical = json.JSONEncoder(sort_keys=True, separators=(",", ":"), ensure_ascii=False).encode
draw = random.SystemRandom().randrange


def require(condition: bool, reason: str) -> None:
    if not condition:
        raise ValueError(reason)


def is_prime(n: int) -> bool:
    """Test as Miller and Rabin do: the first twelve primes decide all n below 3.3e24."""
    bases = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37]
    twos = ((n - 1) & (1 - n)).bit_length() - 1
    powers = [[pow(a, (n - 1) >> k, n) for k in range(1, twos + 1)] for a in bases]
    return all(n - 1 in chain or chain[-1] == 1 for chain in powers)


def value(node: Any, n: Any) -> Any:
    """Evaluate a text of whole numbers, pi, sqrt and + - * / in the numbers n."""
    match node:
        case str():
            return value(ast.parse(node, mode="eval").body, n)
        case ast.Constant(value=int(k)):
            return k * n.one
        case ast.Name(id="pi"):
            return n.pi
        case ast.Call(func=ast.Name(id="sqrt"), args=[a]):
            return n.root(value(a, n))
        case ast.UnaryOp(op=ast.USub(), operand=a):
            return -value(a, n)
        case ast.BinOp(left=a, op=ast.Add() | ast.Sub() as sign, right=b):
            return value(a, n) + value(b, n) * (1 if isinstance(sign, ast.Add) else -1)
        case ast.BinOp(left=a, op=ast.Mult() | ast.Div() as sign, right=b):
            factor = value(b, n) if isinstance(sign, ast.Mult) else n.inverse(value(b, n))
            return n.reduce(value(a, n) * factor)
    raise ValueError(f"{node!r} has no place in a number")


class Circle:
    """What numbers modulo p and those with binary digits have in common: rotations."""

    def point(self: Any) -> Rotation:
        square = self.reduce((t := draw(self.span)) * t)
        below = self.inverse(self.one + square)
        return self.reduce((self.one - square) * below), self.reduce(2 * t * below)

    def compose(self: Any, a: Rotation, b: Rotation) -> Rotation:
        return self.reduce(a[0] * b[0] - a[1] * b[1]), self.reduce(a[0] * b[1] + a[1] * b[0])

    def power(self: Any, a: Rotation, k: int) -> Rotation:
        result = (self.one, 0)
        for bit in f"{abs(k):b}":
            result = self.compose(result, result)
            result = self.compose(result, a) if bit == "1" else result
        return result[0], result[1] if k > 0 else self.reduce(-self.one * result[1])


class Field(Circle):
    """Numbers modulo p; angles are powers of a rotation of this order and of units."""

    def __init__(self, p: int, order: int) -> None:
        self.p, self.span, self.one, self.tiny = p, p, 1, 0
        self.eye = ([1, 0, 0], [0, 1, 0], [0, 0, 1])
        self.reduce, self.inverse = p.__rmod__, partial(pow, exp=-1, mod=p)  # x % p, 1/x
        self.order, self.name, self.pi = order, f"modulo {p}", draw(p)
        self.units, self.steps, self.needed, self.turn = {"0": (1, 0)}, 0, 120, (1, 0)
        require(order % 120 == 0, f"order {order} has no square roots of 2, 3 and 5")
        small = [q for q in range(1, isqrt(order) + 1) if order % q == 0]
        divisors = [d for q in small for d in (q, order // q) if d < order]
        at = lambda d: self.power(self.turn, d)
        while any(at(d) == (1, 0) for d in divisors) or at(order // 4) != (0, 1):  # type: ignore
            self.turn = self.power(self.point(), (p + 1) // order)
        cosine = [self.power(self.turn, order // k)[0] for k in (8, 12, 10)]
        roots = {2: 2 * cosine[0], 3: 2 * cosine[1], 5: 4 * cosine[2] - 1}
        self.root = lambda x: roots.get(x, pow(x, (p + 1) // 4, p))

    def cos_sin(self, s: str, k: int, unit: str) -> Rotation:
        """Turn by s half turns, whole steps of the order, and k times by a random rotation."""
        half = Fraction(s) / 2
        self.needed, self.steps = lcm(self.needed, half.denominator), self.steps + abs(k)
        turn = self.power(self.turn, int(half * self.order) % self.order)
        return self.compose(turn, self.power(self.units.setdefault(unit, self.point()), k))


class Reals(Circle):
    """Numbers with BITS digits behind the binary point; rounding leaves some 2^-700."""

    one, tiny, span, name = 1 << BITS, 1 << BITS // 2, 1 << BITS, f"with {BITS} binary digits"
    eye = ([1 << BITS, 0, 0], [0, 1 << BITS, 0], [0, 0, 1 << BITS])
    reduce = staticmethod(lambda x: x >> BITS)
    inverse = staticmethod(lambda x: (1 << 2 * BITS) // x)
    root = staticmethod(lambda x: isqrt(x << BITS))

    def __init__(self) -> None:
        terms = [(k, 4 * (2 - k % 4) << BITS) for k in range(1, BITS, 2)]
        self.pi = sum(4 * a // (k * 5**k) - a // (k * 239**k) for k, a in terms)

    def cos_sin(self, s: str, k: int, unit: str) -> Vector:
        """Sum the exponential series of a 256th of the angle and double that eight times."""
        x = value(f"{s}*pi + {k}*({unit})", self) % (2 * self.pi) >> 8
        term, sums = self.one, [0, 0]
        for n in range(160):
            sums[n % 2] += term if n % 4 < 2 else -term
            term = (term * x >> BITS) // (n + 1)
        for _ in range(8):
            sums = [(sums[0] ** 2 - sums[1] ** 2) >> BITS, 2 * sums[0] * sums[1] >> BITS]
        return sums


# Vectors; a rotation is given by its columns.
add: Op = lambda *vectors: [sum(parts) for parts in zip(*vectors)]
times: Op = lambda n, v, factor: [n.reduce(x * factor) for x in v]
minus: Op = lambda n, v, f, w: [n.reduce(n.one * x - f * y) for x, y in zip(v, w)] if f else v
apply: Op = lambda n, a, b: [n.reduce(x * b[0] + y * b[1] + z * b[2]) for x, y, z in zip(*a)]
cross: Op = lambda n, a, b: [n.reduce(a[i] * b[i + 1] - a[i + 1] * b[i]) for i in (-2, -1, 0)]
# Turned by x, of length tan(angle/2): e + 2 (x x e + x x (x x e)) / (1 + x.x).
share: Op = lambda n, x: 2 * n.inverse(n.one + n.reduce(sum(c * c for c in x)))
swing: Op = lambda n, x, y, f: times(n, add(y, cross(n, x, y)), f)
turned: Op = lambda n, a, x: [add(e, swing(n, x, cross(n, x, e), share(n, x))) for e in a]


def placed(n: Any, steps: list[list[str]]) -> tuple[list[Vector], Vector]:
    """Return rotation and origin after moves x, y, z and turns about an axis by s pi + k unit."""
    rotation, origin = n.eye, [0, 0, 0]
    for kind, *step in steps:
        if kind == "move":
            origin = add(origin, apply(n, rotation, [value(x, n) for x in step]))
            continue
        (cos, sin), k = n.cos_sin(*step[1:]), "xyz".index(step[0])
        i, j, turn = (k + 1) % 3, (k + 2) % 3, [[*column] for column in n.eye]
        turn[i][i], turn[i][j], turn[j][i], turn[j][j] = cos, sin, -sin, cos
        rotation = [apply(n, rotation, column) for column in turn]
    return rotation, origin


def energy(n: Any, links: list[Any], gravity: Vector) -> Vector:
    """Return 2 h at a random state: what each parameter adds to twice the energy."""
    row, floats = list[int](), links[0][2] == "floating"
    drawn = {x: (draw(n.span), draw(n.span), n.point()) for *_, terms in links for x, *_ in terms}
    x, p, v, w = ([draw(n.span) * floats for _ in "xyz"] for _ in "xpvw")
    frames: dict[str | None, Any] = {None: (turned(n, n.eye, x), p, v, w)}
    for name, antecedent, joint, count, (turn, shift), axis, start, terms in links:
        rotation, p, v, w = frames[antecedent]
        arm, rotation = apply(n, rotation, shift), [apply(n, rotation, e) for e in turn]
        q, qd, k = draw(n.span), draw(n.span), apply(n, rotation, axis)
        turns, slides = joint == "revolute", joint == "prismatic"
        if terms:  # it follows others: a sum, and on the circle a product of powers
            q, qd = (n.reduce(sum(m * drawn[x][i] for x, m, _ in terms)) for i in (0, 1))
            q += start if slides else 0
        if terms and turns:
            cos, sin = reduce(n.compose, [n.power(drawn[x][2], i) for x, _, i in terms], start)
            q = n.reduce(sin * n.inverse(n.one + cos))
        rotation = turned(n, rotation, times(n, k, q)) if turns else rotation
        arm, rate = add(arm, times(n, k, q * slides)), times(n, k, qd)
        p, v = add(p, arm), add(v, cross(n, w, arm), times(n, rate, n.one * slides))
        w = add(w, times(n, rate, n.one * turns))
        frames[name] = (rotation, p, v, w)
        # w'J w, 2 MS.(v x w - g) and M (v.v - 2 g.p), J and MS along the link's own axes.
        x, y, z = (n.reduce(sum(c * d for c, d in zip(e, w))) for e in rotation)
        own = [n.reduce(c) for c in (x * x, 2 * x * y, 2 * x * z, y * y, 2 * y * z, z * z)]
        first = [c - g for c, g in zip(cross(n, v, w), gravity)]
        own += [n.reduce(2 * sum(c * d for c, d in zip(e, first))) for e in rotation]
        own.append(n.reduce(sum(c * c - 2 * g * x for c, g, x in zip(v, gravity, p))))
        row += [*own, n.reduce(sum(c * c for c in rate))][:count]
    return row


def eliminate(n: Any, cert: Any, labels: list[str]) -> int:
    """Eliminate the base columns from random rows: nothing may be left, and beta comes out."""
    robot, links, turns = cert["robot"], list[Any](), 0
    gravity = [value(x, n) for x in robot["gravity"]]
    for link in robot["links"]:
        joint, (start, terms) = link["joint"], link["couple"] or ("0", [])
        follows = joint == "revolute" and bool(terms)
        powers = [Fraction(m) * robot["roots"][x] if follows else Fraction(0) for x, m in terms]
        require({k.denominator for k in powers} <= {1}, f"{link['name']} is at no whole powers")
        alone = {"fixed": 0, "floating": 6}.get(joint, 1)
        turns += int(sum(map(abs, powers))) if follows else alone
        start = n.cos_sin(*start) if follows else value(start, n)
        terms = [(x, value(m, n), int(k)) for (x, m), k in zip(terms, powers)]
        axis, place = [value(x, n) for x in link["axis"]], placed(n, link["placement"])
        head = [link[key] for key in ("name", "antecedent", "joint", "columns")]
        links.append((*head, place, axis, start, terms))
    kept, b = cert["base"] + cert["regrouped"], len(cert["base"])
    pivots: list[tuple[int, Vector]] = []
    first, columns, silent = energy(n, links, gravity), [labels.index(x) for x in kept], 0
    while silent < FRESH:
        full = [n.reduce(n.one * (x - y)) for x, y in zip(energy(n, links, gravity), first)]
        for x in cert["no_effect"]:
            require(abs(full[labels.index(x)]) <= n.tiny, f"{x} has an effect, {n.name}")
        row = [full[column] for column in columns]
        for k, pivot in pivots:
            row = minus(n, row, row[k], pivot)
        k = max(range(b), key=lambda k: abs(row[k]))
        silent = 0 if abs(row[k]) > n.tiny else silent + 1
        if silent == 0:
            pivots.append((k, times(n, row, n.inverse(row[k]))))
        for x, rest in zip(kept[b:], row[b:] if silent else []):
            require(abs(rest) <= n.tiny, f"{x} is no combination of base columns, {n.name}")
    require(len(pivots) == b, f"only {len(pivots)} of {b} base columns are independent, {n.name}")
    beta = {(i, j): text for i, j, text in cert["beta"]}
    for i in reversed(range(b)):
        k, row = pivots[i]
        pivots[:i] = [(c, minus(n, above, above[k], row)) for c, above in pivots[:i]]
        for x, found in zip(kept[b:], row[b:]):
            text = beta.get((kept[k], x), "0")
            require(agrees(n, found, text), f"beta of {kept[k]}, {x} is not {text}, {n.name}")
    return turns


def agrees(n: Any, found: int, text: str) -> bool:
    """Compare a coefficient; modulo a prime, a rounded one only says that there is one."""
    if not text.startswith("nearest "):
        return bool(abs(n.reduce(n.one * (found - value(text, n)))) <= n.tiny)
    m, d = map(int, text[8:].split("/"))
    require(abs(m).bit_length() == 53 and d > 0 and d & (d - 1) == 0, f"{text} is no double")
    return found != 0 if n.one == 1 else 2 * abs(found * d - m * n.one) <= n.one


def check(text: str) -> str:
    """Return a line about an accepted certificate, else raise ValueError or what is malformed."""
    cert = json.loads(text)
    require(canonical(cert) + "\n" == text and sorted(cert) == KEYS.split(), "not in its form")
    require(cert["format"] == "roberval certificate 1", "this is another format")
    robot, base, order, primes = (cert[key] for key in ("robot", "base", "order", "primes"))
    for name, part in (("robot_sha256", robot), ("sha256", {**cert, "sha256": ""})):
        digest = hashlib.sha256(canonical(part).encode()).hexdigest()
        require(cert[name] == digest, f"{name} is that of something else: it was changed")
    links, known = robot["links"], {"revolute", "prismatic", "fixed", 0, 10, 11}
    found = {x[y] for x in links[links[0]["joint"] == "floating" :] for y in ("joint", "columns")}
    require(found <= known and cert["model"] in ("d", "d0", "h"), "no such joint or model")
    labels = [f"{x}_{y['name']}" for y in links for x in KINDS[: y["columns"]]]
    columns = sorted(cert["no_effect"] + base + cert["regrouped"])
    require(columns == sorted({*labels}) == sorted(order), "the columns are not those of the robot")
    require(cert["rank"] == len(base) > 0, "the rank is not the number of base columns")
    for k, (i, j, _) in enumerate(cert["beta"]):
        fits = i in base and j in cert["regrouped"] and order.index(i) < order.index(j)
        require(fits and [i, j] not in [x[:2] for x in cert["beta"][:k]], f"{i}, {j} in beta")
    require({j for _, j, _ in cert["beta"]} == {*cert["regrouped"]}, "beta has an empty column")
    require(len({*primes}) == len(primes) >= 2, "there are less than two primes")
    for p in primes:
        fits = 1 << 61 < p < 1 << 62 and (p + 1) % cert["angle_order"] == 0 and is_prime(p)
        require(fits, f"{p} is no prime of 62 bits, -1 modulo the angles' order")
        turns = eliminate(field := Field(p, cert["angle_order"]), cert, labels)
        require(field.needed == cert["angle_order"], f"the angles' order is {field.needed}")
    eliminate(Reals(), cert, labels)
    degree = 6 * (turns + field.steps) + 2
    require(cert["degree"] == degree, f"the degree is {degree}")
    numbers = sum(not any(map(str.isalpha, unit)) for unit in field.units)  # "0" among them
    generic = len(field.units) - (2 if numbers == 2 else 1)
    require(len(cert["generic"]) == generic, f"{generic} angles are generic")
    bits = ((len(base) * degree) ** len(primes)).bit_length() - prod(primes).bit_length() + 1
    require(cert["failure_log2"] == bits < 0, f"the rank may be too low with probability 2^{bits}")
    return f"accepted: {robot['name']}: {len(base)} base parameters of {len(labels)}"


if __name__ == "__main__":
    code, verdict = 2, f"cannot read {' '.join(sys.argv[1:]) or 'anything'}"
    try:
        require(len(sys.argv) == 2, "give one file, as in: python check_certificate.py cert.json")
        text = Path(sys.argv[1]).read_text(encoding="utf-8")
        require(isinstance(json.loads(text), dict) and '"sha256"' in text, "this is no certificate")
        code, verdict = 1, "refused"
        code, verdict = 0, check(text)
    except Exception as error:  # whatever a malformed file leads to
        verdict += f": {error if isinstance(error, OSError | ValueError) else repr(error)}"
    print(verdict, file=sys.stderr if code else sys.stdout)
    sys.exit(code)
