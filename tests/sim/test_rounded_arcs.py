# SPDX-License-Identifier: Apache-2.0
"""Arcs whose numbers are rounded to their last decimal are taken, on a machine of any
pulse, and cut beside the arc that was meant by that rounding only.  What is farther
off was not meant so, and is refused.

EDM_SEED repeats a run.
"""
import math
import re

import numpy as np
import pytest
from edmsim import places, run, seeded

ARCS = 60
UNITS = [("G21", 2), ("G21", 3), ("G21", 4), ("G20", 3), ("G20", 4), ("G20", 5)]
PULSES_MM = [1e-2, 1e-3, 1e-4, 1e-5]
STAYS = "".join(f"[axis.{a}]\npresent = no\n" for a in "ZABC")
WIRE = ("[wire]\nguides = relative\nz_lower_mm = -20\nz_upper_mm = 80\n"
        "z_second_mm = 40\nangle_max_deg = 45\n")


def machine(folder, pulse_mm, wire=False, strategy="simultaneous"):
    path = folder / "m.ini"
    axes = "XYUV" if wire else "XYZ"
    path.write_text(
        f"[machine]\nname = m\nstrategy = {strategy}\n" + STAYS * wire +
        "".join(f"[axis.{a}]\npulse_mm = {pulse_mm:.5f}\ntravel_min_mm = -200\n"
                "travel_max_mm = 200\n" for a in axes) + WIRE * wire)
    return path


class Digits:
    """Numbers in the units of a program, with so many decimals."""

    def __init__(self, units, decimals):
        self.units, self.decimals = units, decimals
        self.mm = 25.4 if units == "G20" else 1
        self.digit_mm = self.mm * 10.0 ** -decimals

    def __call__(self, mm):
        return f"{mm / self.mm:.{self.decimals}f}"

    def value(self, mm):
        return float(self(mm)) * self.mm


class Arc:
    """A random one, in mm, and the places that a program writes of it."""

    def __init__(self, rnd, n, most_turn=math.tau, least_mm=0.1):
        # An arc of a digit or two has no radius to speak of.
        self.r = math.exp(rnd.uniform(math.log(least_mm), math.log(50)))
        self.centre = np.array([rnd.uniform(-60, 60) for _ in "xy"])
        self.from_ = rnd.uniform(0, math.tau)
        least = min(1, 3 * n.digit_mm / self.r)
        self.turn = rnd.choice([rnd.uniform(least, most_turn), math.pi,
                                rnd.uniform(least, 1)])
        self.turn = max(self.turn, least)
        self.sense = rnd.choice([1, -1])
        self.n = n
        self.start = self.at(0)
        self.end = self.at(1)

    def at(self, share, r=None):
        a = self.from_ + self.sense * self.turn * share
        return self.centre + (r or self.r) * np.array([math.cos(a), math.sin(a)])

    def way(self, share):
        a = self.from_ + self.sense * self.turn * share
        return self.sense * np.array([-math.sin(a), math.cos(a)])

    def g(self):
        return f"G{3 if self.sense > 0 else 2}"

    def words(self, at, letters="XY"):
        return " ".join(c + self.n(v) for c, v in zip(letters, at))

    def ij(self, letters="IJ"):
        return self.words(self.centre - self.start, letters)

    def is_one(self):
        """Not rounded to a full circle."""
        return self.words(self.start) != self.words(self.end)

    def ends_in_zeros(self):
        """Both words of a place do: it may be rounded to fewer decimals."""
        return any(all(w.endswith("0") for w in words.split())
                   for words in (self.words(self.end), self.ij(),
                                 self.words(self.centre), self.n(self.r)))


def arcs(rnd, n, count=ARCS, **how):
    while count:
        a = Arc(rnd, n, **how)
        if a.is_one() and not a.ends_in_zeros():
            yield a
            count -= 1


def by_centre(a):
    return [f"G0 {a.words(a.start)}", f"{a.g()} {a.words(a.end)} {a.ij()}"]


def by_radius(a):
    r = a.r if a.turn <= math.pi else -a.r
    return [f"G0 {a.words(a.start)}", f"{a.g()} {a.words(a.end)} R{a.n(r)}"]


def by_places(a):
    return [f"G0 {a.words(a.start)}",
            f"G90.1 {a.g()} {a.words(a.end)} {a.words(a.centre, 'IJ')}"]


def under_g41(a):
    """Leads along the tangents, and the wire outside."""
    lead = a.start - 2 * a.way(0), a.end + 2 * a.way(1)
    return ["G40 H1", f"G0 {a.words(lead[0])}",
            f"{'G42' if a.sense > 0 else 'G41'} G1 {a.words(a.start)}",
            f"{a.g()} {a.words(a.end)} {a.ij()}", f"G40 G1 {a.words(lead[1])}"]


def with_top(a):
    """The top goes round a centre of its own."""
    top = Arc.__new__(Arc)
    top.__dict__.update(a.__dict__)
    top.r *= 1.3
    top.centre = a.centre + (a.start - a.centre) * -0.3     # it begins upright
    lean = top.at(1) - a.end
    return [f"G0 {a.words(a.start)} {a.words((0, 0), 'UV')}",
            f"{a.g()} {a.words(a.end)} {a.ij()} {a.words(lean, 'UV')} "
            f"{a.words(top.centre - a.centre, 'KL')}",
            f"G1 {a.words((0, 0), 'UV')}"]


KINDS = {
    "centre": (by_centre, "generic", {}), "radius": (by_radius, "generic", {}),
    "places": (by_places, "generic", {}),
    "G41": (under_g41, "generic", {"most_turn": 4}),
    "UV": (with_top, "fanuc-wire", {}),
}


def program(n, lines):
    return "\n".join([f"{n.units} G90 G17", "F" + n(1.27)] + lines + ["M2", ""])


@pytest.mark.parametrize("pulse_mm", PULSES_MM)
@pytest.mark.parametrize("units, decimals", UNITS)
@pytest.mark.parametrize("kind", KINDS)
def test_what_is_rounded_to_its_last_decimal_is_taken(kind, units, decimals,
                                                      pulse_mm, tmp_path):
    write, dialect, how = KINDS[kind]
    n = Digits(units, decimals)
    lines = [w for a in arcs(seeded(), n, **how) for w in write(a)]
    if kind == "G41":
        lines.insert(0, "H1=" + n(0.0508))
    path = machine(tmp_path, pulse_mm, wire=kind in ("G41", "UV"))
    r = run("--machine", path, "--dialect", dialect, "--check",
            text=program(n, lines))
    said = re.search(rb":(\d+):.*error.*", r.stderr)
    assert r.returncode == 0, (said, said and lines[int(said[1]) - 4:
                                                    int(said[1]) - 2])


def beyond(a, most_mm):
    """Its end moved outward by more than roundings can do."""
    out = a.at(1) - a.centre
    a.end = a.end + out / a.r * (most_mm + 3 * a.n.digit_mm)
    return a


@pytest.mark.parametrize("pulse_mm", PULSES_MM)
@pytest.mark.parametrize("units, decimals", UNITS)
@pytest.mark.parametrize("kind", ["centre", "places", "G41", "UV"])
def test_what_is_farther_off_is_refused(kind, units, decimals, pulse_mm, tmp_path):
    write, dialect, how = KINDS[kind]
    n = Digits(units, decimals)
    path = machine(tmp_path, pulse_mm, wire=kind in ("G41", "UV"))
    most = 2 * math.sqrt(2) * n.digit_mm * (1 + (kind == "UV"))
    for a in arcs(seeded(), n, 2, **how):
        lines = ["H1=" + n(0.0508)] * (kind == "G41") + write(beyond(a, most))
        if a.ends_in_zeros():
            continue
        r = run("--machine", path, "--dialect", dialect, "--check",
                text=program(n, lines))
        assert r.returncode == 65 and b"mm from its centre and ends" in r.stderr, \
            (lines, r.stderr)


@pytest.mark.parametrize("pulse_mm", [1e-3, 1e-4])
@pytest.mark.parametrize("units, decimals", UNITS)
def test_what_is_emitted_of_it_is_taken_again(units, decimals, pulse_mm, tmp_path):
    """Its centre is the one by which both ends are on one circle."""
    n = Digits(units, decimals)
    path = machine(tmp_path, pulse_mm)
    lines = [w for a in arcs(seeded(), n) for w in by_centre(a)]
    job = run("--machine", path, "--emit", "iso", text=program(n, lines))
    assert job.returncode == 0, job.stderr
    r = run("--machine", path, "--check", text=job.stdout.decode())
    assert r.returncode == 0, r.stderr


@pytest.mark.parametrize("units, decimals", UNITS)
def test_a_radius_too_short_by_more_than_a_rounding_is_refused(units, decimals,
                                                               tmp_path):
    n = Digits(units, decimals)
    path = machine(tmp_path, 1e-3)
    for a in arcs(seeded(), n, 8):
        a.turn = math.pi
        a.end = a.at(1)
        a.r -= 2.5 * n.digit_mm
        if a.r < 0.05 or not a.is_one() or a.ends_in_zeros():
            continue
        r = run("--machine", path, "--check", text=program(n, by_radius(a)))
        assert r.returncode == 65 and b"too small to reach the end" in r.stderr


@pytest.mark.parametrize("strategy", ["simultaneous", "point-by-point",
                                      "min-switch", "main-direction"])
@pytest.mark.parametrize("units, decimals", [("G21", 2), ("G21", 3), ("G20", 3)])
def test_it_is_cut_where_it_was_meant(units, decimals, strategy, tmp_path):
    """Each lattice point is beside the arc by its roundings only, and the way round
    is as long."""
    n = Digits(units, decimals)
    path = machine(tmp_path, 1e-3, strategy=strategy)
    for a in arcs(seeded(), n, 6, least_mm=max(0.1, 6 * n.digit_mm)):
        a.centre = a.centre / 20
        a.r = min(a.r, 4)
        a.start, a.end = a.at(0), a.at(1)
        if not a.is_one():
            continue
        rows = np.array(places("--machine", path, "--dry-run",
                               text=program(n, by_centre(a))))[:, :2] * 1e-3
        at = np.argmin(np.hypot(*(rows - [n.value(v) for v in a.start]).T))
        way = rows[at:]
        out = np.hypot(*(way - a.centre).T)
        assert np.abs(out - a.r).max() < 3 * n.digit_mm + 3e-3, by_centre(a)
        turned = np.unwrap(np.arctan2(*(way - a.centre).T[::-1]))
        turned = a.sense * (turned[-1] - turned[0])
        assert abs(turned - a.turn) * a.r < 4 * n.digit_mm + 4e-3, by_centre(a)


def pulses_of(rows, axes):
    return int(sum(np.abs(np.diff(np.array(rows)[:, a])).sum() for a in axes))


@pytest.mark.parametrize("strategy", ["simultaneous", "point-by-point", "centred",
                                      "main-direction", "min-switch"])
@pytest.mark.parametrize("kind", ["centre", "places", "G41", "UV"])
def test_whether_it_goes_round_is_told_by_what_is_written(kind, strategy, tmp_path):
    """Its ends are less than a pulse apart: in front of its start it goes round,
    behind it it goes nowhere.  What is written of it by --emit says the same."""
    write, dialect, _ = KINDS[kind]
    n = Digits("G21", 6)
    path = machine(tmp_path, 1e-2, wire=kind in ("G41", "UV"), strategy=strategy)
    rnd = seeded()
    for i in range(8):
        a = Arc(rnd, n)
        a.centre = a.centre / 20
        a.r = math.exp(rnd.uniform(math.log(0.2), math.log(3)))
        bit = math.exp(rnd.uniform(math.log(3e-6), math.log(9e-3))) / a.r
        a.turn = bit if i % 2 else math.tau - bit
        a.start, a.end = a.at(0), a.at(1)
        text = program(n, ["H1=0"] * (kind == "G41") + write(a))
        nowhere = re.sub(r"^(?:G90.1 )?G[23] (\S+ \S+).*$", r"G1 \1", text,
                         flags=re.MULTILINE)
        here, base = (places("--machine", path, "--dialect", dialect,
                             "--dry-run", text=t) for t in (text, nowhere))
        for axes in [(0, 1)] + [(6, 7)] * (kind == "UV"):
            round_ = pulses_of(here, axes) - pulses_of(base, axes)
            # The guides are beside the planes: they go round smaller circles.
            most = 8 * a.r / 1e-2 * (0.7 if kind == "UV" else 0.9)
            assert round_ < 8 if i % 2 else round_ > most, (round_, most, text)
        if kind == "UV":                # two contours cannot be emitted
            continue
        job = run("--machine", path, "--emit", "iso", text=text)
        emitted = places("--machine", path, "--dry-run", text=job.stdout.decode())
        assert abs(pulses_of(emitted, (0, 1)) - pulses_of(here, (0, 1))) < \
            2 * a.r / 1e-2, (text, job.stdout)


@pytest.mark.parametrize("dialect, text, taken", [
    # A macro's value has the decimals that the control keeps.
    ("linuxcnc", "#1=5.00007\nG0 X0 Y0\nG3 X[#1*2] Y[0] I[5] J[0]", True),
    ("linuxcnc", "#1=5.005\nG0 X0 Y0\nG3 X[#1*2] Y[0] I[5] J[0]", False),
    # So has a length without a point, where it counts in them.
    ("skd2", "G92 X0 Y0\nG3 X10002 Y0 I5000 J0", True),
    ("skd2", "G92 X0 Y0\nG3 X10004 Y0 I5000 J0", False),
    # Zeros at the end may be left out, but nobody rounds to tenths.
    ("generic", "G0 X0 Y0\nG3 X10.02 Y0 I5. J0", True),
    ("generic", "G0 X0 Y0\nG3 X10.1 Y0 I5. J0", False),
    ("generic", "G0 X0 Y0\nG3 X 10.02 Y - 0 I 5. J0.", True),
])
def test_the_last_digit_of_values_and_whole_numbers(dialect, text, taken, tmp_path):
    path = machine(tmp_path, 1e-3, wire=dialect == "skd2")
    r = run("--machine", path, "--dialect", dialect, "--check",
            text=f"G90\nF5\n{text}\nM2\n")
    assert r.returncode == (0 if taken else 65), r.stderr
    assert taken or b"mm from its centre and ends" in r.stderr, r.stderr


def test_the_smallest_one_that_was_refused(tmp_path):
    r = run("--machine", machine(tmp_path, 1e-3, wire=True), "--dialect",
            "fanuc-wire", "--check", text="G20 G90\nG92 X0. Y0.\n"
            "G1 X-0.0289 Y0.2501\nG3 X0.0015 Y0.3082 I-0.0042 J0.0391\nM02\n")
    assert r.returncode == 0, r.stderr
