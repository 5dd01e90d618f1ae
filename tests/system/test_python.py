# SPDX-License-Identifier: Apache-2.0
"""The Python package in clients/python: the same bytes, the same promises."""

import os
import pathlib
import shutil
import subprocess
import sys
import textwrap

import rig
from rig import SLOW_JOB

ROOT = pathlib.Path(__file__).resolve().parents[2]


def python(text, *args, env=None):
    """Run @text with the package; rig has LCM's own `edm` in this process."""
    return subprocess.run(
        [sys.executable, "-c", textwrap.dedent(text), *map(str, args)],
        capture_output=True, text=True, timeout=60, cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT / "clients/python"),
             **(env or {})})


def good(*args, **more):
    r = python(*args, **more)
    assert r.returncode == 0, r.stderr
    return r.stdout


def test_it_is_installed_by_pip_and_typed(tmp_path):
    source, target = tmp_path / "source", tmp_path / "target"
    shutil.copytree(ROOT / "clients/python", source)
    # What it needs is in this environment; there is no network here.
    subprocess.run([sys.executable, "-m", "pip", "install", "-q", "--no-deps",
                    "--no-index", "--no-build-isolation", "--target", target,
                    source], check=True, timeout=300)
    assert (target / "edm" / "py.typed").exists()
    out = good("import edm; print(edm.__file__); edm.Client",
               env={"PYTHONPATH": str(target)})
    assert out.startswith(str(target))
    r = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--cache-dir",
         tmp_path / "cache", target / "edm"], capture_output=True, text=True,
        cwd=tmp_path, timeout=600)
    assert r.returncode == 0, r.stdout


def test_its_types_are_those_of_lcm_gen(tmp_path):
    out = good("""
        from edm import messages as m
        print(*m.Status.__dataclass_fields__, sep=",")
        for k in ("SIGNED", "COMMAND", "ACK", "JOB_CHUNK", "STATUS", "EVENT"):
            print(getattr(m, k).hex())
        print(m.Command(99, "me", 7, "jog", "j", 1.5, "X").encode().hex())
        print(m.JobChunk(99, "me", 8, "j", "n", 3, bytes(32), 0, 1, 0, True,
                         data=b"abc").encode().hex())
    """).split()
    assert out.pop(0).split(",") == rig.status_t.__slots__
    kinds = (rig.signed_t, rig.command_t, rig.ack_t, rig.job_chunk_t,
             rig.status_t, rig.event_t)
    assert out[:6] == [k._get_packed_fingerprint().hex() for k in kinds]
    c = rig.command_t()
    c.utime, c.client, c.seq, c.verb, c.job, c.arg, c.text = (
        99, "me", 7, "jog", "j", 1.5, "X")
    assert out[6] == c.encode().hex()
    j = rig.job_chunk_t()
    j.utime, j.client, j.seq, j.job, j.name = 99, "me", 8, "j", "n"
    j.bytes, j.sha256, j.chunk, j.chunks, j.offset = 3, bytes(32), 0, 1, 0
    j.hold, j.size, j.data = True, 3, b"abc"
    assert out[7] == j.encode().hex()


def test_the_vectors_of_the_readme_hold():
    good("""
        from nacl.signing import SigningKey
        from edm.layout import to_be_signed
        from edm.messages import Signed
        v = dict(line.split() for line in open("messages/vectors.txt")
                 if not line.startswith("#"))
        key = SigningKey(bytes.fromhex(v["seed"]))
        assert bytes(key.verify_key).hex() == v["public"]
        what = to_be_signed(v["channel"], int(v["boot"]), int(v["count"]),
                            bytes.fromhex(v["data"]))
        assert what.hex() == v["signed"]
        signature = key.sign(what).signature
        assert signature.hex() == v["signature"]
        s = Signed(bytes(key.verify_key), int(v["boot"]), int(v["count"]),
                   signature, bytes.fromhex(v["data"]))
        assert s.encode().hex() == v["packet"]
        assert Signed.decode(s.encode()) == s
    """)


def test_it_commands_a_machine(machine):
    (machine.folder / "slow.ngc").write_bytes(SLOW_JOB)
    out = good("""
        import sys, edm
        with edm.Client(sys.argv[1]) as m:
            assert m.status().state == "idle"
            m.jog("Y", 0.5)
            while abs(m.status().pos_mm[1] - 0.5) > 1e-6:
                pass
            job = m.submit(open(sys.argv[2], "rb").read(), "slow.ngc")
            last = [s.progress for s in m.follow(job.id)]
            assert last == sorted(last) and len(last) > 5
            assert m.show(job.id)["state"] == "done"
            for ask in (m.start, lambda: m.jog("Q", 1),
                        lambda: m.submit(b"G1 X1 F60 Q9", "bad.ngc")):
                try:
                    ask()
                except edm.Refused as e:
                    print(e.code, e.reason)
    """, machine.name, machine.folder / "slow.ngc")
    told = out.splitlines()
    assert told[0].startswith("1 no job in the queue")
    assert told[1].startswith("65 no axis 'Q'")
    assert told[2].startswith("65 bad.ngc:1:11: error: ")


def talk(code, *args):
    """A program that is talked to."""
    return subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(code), *map(str, args)],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT / "clients/python")})


def test_a_status_is_told_after_it_was_asked_for(machine):
    """Not one that came while nobody listened."""
    p = talk("""
        import sys, edm
        m = edm.Client(sys.argv[1], timeout=20)
        m.jog("Y", 0.5)
        print("jog", flush=True)
        sys.stdin.readline()
        print(m.status().pos_mm[1], flush=True)
    """, machine.name)
    assert p.stdout.readline() == "jog\n"
    machine.client.status_where(
        lambda s: abs(s.pos_mm[1] - 0.5) < 1e-6 and s.state == "idle")
    out, _ = p.communicate("go\n", timeout=40)
    assert abs(float(out) - 0.5) < 1e-6


def test_it_goes_on_after_the_service_was_started_anew(machine):
    """It is told the new boot number, and signs again."""
    p = talk("""
        import sys, edm
        m = edm.Client(sys.argv[1], timeout=20)
        print(m.status().state, flush=True)
        sys.stdin.readline()
        m.estop()
        print(m.ask("hello").body, flush=True)
    """, machine.name)
    assert p.stdout.readline() == "idle\n"
    machine.kill("jobs")
    machine.start_jobs()
    out, _ = p.communicate("go\n", timeout=40)
    assert p.returncode == 0
    assert '"role":"service"' in out
    machine.client.status_where(lambda s: s.fault == "e-stop")


def test_a_bad_key_file_is_an_error_that_says_what_mends_it(machine, tmp_path):
    bad = tmp_path / "bad.key"
    bad.write_text(pathlib.Path(machine.client.key).read_text())
    bad.chmod(0o644)
    for key, wanted in ((bad, "make a new one"),
                        (tmp_path / "none", "edmctl keys add")):
        r = python("import sys, edm; edm.Client(sys.argv[1])", machine.name,
                   env={"EDM_KEY": str(key)})
        assert r.returncode == 1
        assert "KeyFileError" in r.stderr and wanted in r.stderr
