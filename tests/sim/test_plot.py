# SPDX-License-Identifier: Apache-2.0
"""The picture of a run: everything drawn lies on the page."""
import re
import xml.etree.ElementTree as ET

import pytest
from edmsim import ROOT, done

PAGE = 1600, 1100
PATH = 0, 600, 95, 640      # the panel of the path, above that of a few jumps


SVG = "{http://www.w3.org/2000/svg}"


def places(of):
    return [tuple(map(float, p)) for d in of.iter(SVG + "path")
            for p in re.findall(r"([-\d.]+),([-\d.]+)", d.get("d"))]


def assert_on_page(svg, panel):
    root = ET.parse(svg).getroot()
    for marks in list(root.iter(SVG + "defs")):
        marks.clear()
    at = places(root)
    assert len(at) > 100
    for x, y in at:
        assert 0 <= x <= PAGE[0] and 0 <= y <= PAGE[1], (x, y)
    # The curves of the first panel, with their key.
    first = [g for g in root.iter(SVG + "g")
             if re.fullmatch(r"gnuplot_plot_\d+a", g.get("id", ""))]
    assert len(first) > 2
    for x, y in sum(map(places, first), []):
        assert panel[0] < x < panel[1] and panel[2] < y < panel[3], (x, y)


@pytest.mark.parametrize("x,y,z", [
    (1, 1, 1), (1, 1, 30), (1, 1, 12), (1, 1, 3), (12, 12, 1), (1, 12, 1),
    (12, 1, 1), (1, 12, 12), (0.1, 3, 2), (30, 1, 1), (5, 0, 60)])
def test_a_path_of_any_extents_fits_its_panel(tmp_path, x, y, z):
    svg = tmp_path / "p.svg"
    done("--dry-run", "--plot", svg, text=f"G21 G90 F900\nG1 X{x}\nY{y}\n"
         f"Z{-z}\nX0 Y0\nM2\n")
    assert_on_page(svg, (0, 600, 95, 1100))


def test_the_shipped_orbit_fits_its_panel(tmp_path):
    svg = tmp_path / "p.svg"
    done("--plot", svg, "--machine", ROOT / "examples/machine.ini",
         ROOT / "examples/orbit.ngc")
    assert_on_page(svg, PATH)


def test_an_upper_guide_by_places_is_drawn_at_its_places(tmp_path):
    """A cone whose guides go round at 5.94 and 0.70 mm."""
    svg, ini = tmp_path / "p.svg", tmp_path / "m.ini"
    ini.write_text("[machine]\nname = m\n[wire]\nguides = absolute\n"
                   "[axis.Z]\npresent = no\n[axis.A]\npresent = no\n"
                   "[axis.B]\npresent = no\n[axis.C]\npresent = no\n")
    done("--dry-run", "--plot", svg, "--machine", ini, "--dialect", "3b",
         "--taper", 3, "--wire-offset", 0.11,
         text="B5000 B0 B5000 GX L1\nB5000 B0 B20000 GY NR1\n"
              "B5000 B0 B5000 GX L3\nDD\n")
    wide = {}
    for g in ET.parse(svg).getroot().iter(SVG + "g"):
        title = g.find(SVG + "title")
        if title is not None and title.text in ("cut", "upper guide"):
            # The last piece of each is its sample in the key.
            x = [p[0] for p in places(g)]
            wide[title.text] = max(x) - min(x)
    assert 0.1 < wide["upper guide"] / wide["cut"] < 0.6
