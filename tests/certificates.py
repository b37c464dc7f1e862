"""Check certificates by the dozen: `python certificates.py verdicts|mutations DIRECTORY`.

Run by the Rust tests, which write the certificates; needs neither roberval nor pytest.
"""

from __future__ import annotations

import copy
import hashlib
import json
import runpy
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

CHECKER = runpy.run_path(
    str(Path(__file__).parents[1] / "python" / "roberval" / "check_certificate.py")
)
check, canonical = CHECKER["check"], CHECKER["canonical"]

# What a certificate records and nobody can check: see the checker's first lines.
RECORDS = {"version", "model", "seeds", "samples", "rounding_error", "changes", "witnesses"}


def verdict(text: str) -> str:
    """Return the checker's line; malformed certificates are refused by whatever they cause."""
    try:
        return str(check(text))
    except Exception as error:
        return f"refused: {error}"


def verdicts(directory: Path) -> list[str]:
    """List the files whose verdict is not the one that their name begins with."""
    faults = []
    for path in sorted(directory.iterdir()):
        found = verdict(path.read_text(encoding="utf-8"))
        if not found.startswith(path.name.split("-")[0]):
            faults.append(f"{path.name}: {found}")
    return faults


def leaves(part: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """List the ways to all numbers and texts."""
    keys: Any = []
    if isinstance(part, dict):
        keys = part
    elif isinstance(part, list):
        keys = range(len(part))
    else:
        yield path
    for key in keys:
        yield from leaves(part[key], (*path, key))


def other(leaf: Any) -> list[Any]:
    """Change a number or text a little, in ways that keep it readable where there are any."""
    if isinstance(leaf, bool):
        return [not leaf]
    if isinstance(leaf, int):
        return [leaf + 1, -leaf, 2 * leaf]
    if leaf is None:
        return ["1"]
    if leaf.startswith("nearest "):
        m, k = leaf[8:].split("*2^")
        return [f"nearest {int(m) + 1}*2^{k}", f"nearest {m}*2^{int(k) - 1}", m, leaf[8:]]
    if leaf.lstrip("-").replace("/", "").isdigit():
        return [f"{leaf} + 1/1000000007", f"-({leaf})"] if leaf != "0" else ["1/1000000007"]
    return [leaf + "x", f"1/2 * {leaf}"]


def replaced(cert: Any, path: tuple[Any, ...], leaf: Any) -> Any:
    changed = copy.deepcopy(cert)
    part = changed
    for key in path[:-1]:
        part = part[key]
    part[path[-1]] = leaf
    return changed


def sealed(cert: Any) -> Any:
    """Return the certificate as a forger would: with hashes that fit."""
    cert["robot_sha256"] = hashlib.sha256(canonical(cert["robot"]).encode()).hexdigest()
    cert["sha256"] = hashlib.sha256(canonical({**cert, "sha256": ""}).encode()).hexdigest()
    return cert


def forgeries(cert: Any) -> Iterator[tuple[str, Any]]:
    """Make false certificates whose parts fit each other."""
    empty, base, gone = cert["no_effect"], cert["base"], cert["regrouped"]
    beta = cert["beta"]
    for k, entry in enumerate(beta):
        yield f"without {entry}", {**cert, "beta": beta[:k] + beta[k + 1 :]}
    for x in base:
        rest = {"base": [y for y in base if y != x], "rank": cert["rank"] - 1}
        kept = [entry for entry in beta if entry[0] != x]
        target = next(
            (y for y in rest["base"] if cert["order"].index(y) < cert["order"].index(x)), x
        )
        more = {"regrouped": [*gone, x], "beta": [*kept, [target, x, "1"]]}
        yield f"{x} regrouped", {**cert, **rest, **more}
        yield f"{x} without effect", {**cert, **rest, "no_effect": [*empty, x], "beta": kept}
    for x in [*gone, *empty]:
        kept = [entry for entry in beta if entry[1] != x]
        rest = {"regrouped": [y for y in gone if y != x], "no_effect": [y for y in empty if y != x]}
        more = {"base": [*base, x], "rank": cert["rank"] + 1, "beta": kept}
        yield f"{x} in the base", {**cert, **rest, **more}
        if x in gone:
            rest["no_effect"] = [*empty, x]
        else:
            rest["regrouped"] = [*gone, x]
        yield f"{x} in the other class", {**cert, **rest, "beta": kept}
    for k, link in enumerate(cert["robot"]["links"]):
        for m, (kind, *step) in enumerate(link["placement"]):
            at = ("robot", "links", k, "placement", m)
            for other_kind in (kind + "x", kind.upper(), "", None, 0):
                yield f"a {other_kind}", replaced(cert, (*at, 0), other_kind)
            yield f"a {kind} too long", replaced(cert, at, [kind, *step, "0"])
            yield f"a {kind} too short", replaced(cert, at, [kind, *step[:-1]])
            if kind == "turn":
                for axis in ("", "xy", "X", "w", 0):
                    yield f"a turn about {axis}", replaced(cert, (*at, 1), axis)
        for joint in (link["joint"] + "x", "", None):
            yield f"a {joint} joint", replaced(cert, ("robot", "links", k, "joint"), joint)
    yield "order turned round", {**cert, "order": cert["order"][::-1]}


def mutations(directory: Path) -> list[str]:
    """Change every leaf of every certificate, with and without hashes that fit."""
    faults, count = [], 0
    for path in sorted(directory.iterdir()):
        cert = json.loads(path.read_text(encoding="utf-8"))
        for at in leaves(cert):
            leaf = cert
            for key in at:
                leaf = leaf[key]
            for new in other(leaf):
                changed = replaced(cert, at, new)
                # Records and the robot may be forged into something else that is true.
                forged = at[0] not in {"sha256", "robot_sha256", "robot", "generic", *RECORDS}
                texts = [canonical(changed)] + [canonical(sealed(changed))] * forged
                for text in texts:
                    count += 1
                    if new != leaf and verdict(text + "\n").startswith("accepted"):
                        faults.append(f"{path.name}: {at} {leaf!r} -> {new!r}: accepted")
        for what, forged in forgeries(cert):
            count += 1
            if verdict(canonical(sealed(copy.deepcopy(forged))) + "\n").startswith("accepted"):
                faults.append(f"{path.name}: {what}: accepted")
        text = path.read_text(encoding="utf-8")
        for changed in (
            text[:-1],
            text + " ",
            " " + text,
            text.replace(",", ", ", 1),
            text[:99],
            "",
        ):
            count += 1
            if verdict(changed).startswith("accepted"):
                faults.append(f"{path.name}: accepted with other bytes")
    print(f"{count} changed certificates, {len(faults)} accepted")
    return faults


if __name__ == "__main__":
    what = {"verdicts": verdicts, "mutations": mutations}[sys.argv[1]]
    faults = what(Path(sys.argv[2]))
    sys.exit("\n".join(faults) if faults else 0)
