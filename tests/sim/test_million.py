# SPDX-License-Identifier: Apache-2.0
"""A million short segments, to the end, back and to the end again; a hundred
thousand by the strategies that take as much memory for each."""
import random
import shutil
import subprocess

import pytest
from edmsim import HANGS_S, STRATEGIES, done

SEGMENTS = {"simultaneous": 1000000}
OTHERS = 100000

# The legs share the rows at their ends.  Places only: at a node the line is
# that of the segment the walk is in, which depends on the direction.
COMPARE = r"""
set -e
cut -d, -f3- "$1" | tail -n +2 >places
rows=$(wc -l <places)
test $(((rows - 1) % 3)) = 0
n=$(((rows - 1) / 3))
head -n $((n + 1)) places >out
tail -n +$((n + 1)) places | head -n $((n + 1)) | tac | cmp - out
tail -n +$((2 * n + 1)) places | cmp - out
echo $n
"""


def job(name, segments):
    """Half of the ends lie between two pulses."""
    rnd = random.Random(9)
    with open(name, "w") as f:
        f.write("G21 G91 F1000\n")
        for n in range(segments):
            d = rnd.choice((-3, -2, 2, 3)) / 1000 + n % 2 * 0.0005
            f.write(f"G1X{d:.4f}Y{-d / 3:.4f}\n" if n % 3 else f"G1Z{d:.4f}\n")


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_many_segments_to_and_fro_pulse_for_pulse(tmp_path, strategy):
    segments = SEGMENTS.get(strategy, OTHERS)
    job(tmp_path / "job.ngc", segments)
    done("--dry-run", "--there-and-back", "--strategy", strategy,
         "--pulses", tmp_path / "p.csv", tmp_path / "job.ngc")
    r = subprocess.run(["sh", "-c", COMPARE, "sh", "p.csv"], cwd=tmp_path,
                       capture_output=True, text=True, timeout=HANGS_S)
    assert r.returncode == 0, r.stdout + r.stderr
    assert int(r.stdout) > 1.8 * segments
    shutil.rmtree(tmp_path)
