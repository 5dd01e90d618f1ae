# SPDX-License-Identifier: Apache-2.0
"""Jobs in chunks over LCM: whole or not at all, once, and only if good."""

import json
import random
import resource

from rig import CHUNK, QUICK_JOB, SLOW_JOB, Client

# 200 short lines: some KiB, and quickly walked.
LONG_JOB = b"G21 G90 F600\n" + b"".join(
    b"G1 X%d.%03d (a line of the job in chunks)\n" % (0, i)
    for i in range(200)
) + b"M30\n"


def test_a_job_goes_from_chunks_to_done_and_status_tells(machine):
    c = machine.client
    a = c.submit(SLOW_JOB, "one")
    assert a.code == 0, a.reason
    assert json.loads(a.body)["job"] == "one"
    running = c.status_where(lambda s: s.job_state == "running")
    assert running.job == "one"
    assert running.job_name == "job.ngc"
    assert running.daemon == "ok"
    assert running.lines == 3
    assert abs(running.length_mm - 2) < 1e-6
    half = c.status_where(lambda s: s.progress > 0.5)
    assert 1 < half.pos_mm[0] <= 2
    assert half.eta_s < 1.5
    j = c.job_where("one", "done")
    assert abs(j["path_mm"] - 2) < 1e-3
    assert abs(j["job_s"] - 2) < 0.3
    # On a busy host it may take longer than its forecast, and says so.
    kinds = [e.kind for e in c.events if e.job == "one" and e.kind not in
             ("longer", "forecast")]
    assert kinds == ["queued", "begun", "ended"]
    assert c.status_where(lambda s: not s.job).state == "idle"


def test_status_comes_ten_times_a_second(machine):
    c = machine.client
    c.status()
    n = len(c.statuses)
    c.hear(2.0)
    assert 16 <= len(c.statuses) - n <= 24


def test_chunks_may_come_in_any_order_and_twice(machine):
    c = machine.client
    chunks = c.chunks(LONG_JOB, "mixed", size=500)
    assert len(chunks) > 10
    mixed = chunks + chunks[:7]
    random.Random(1).shuffle(mixed)
    for m in mixed:
        c.send([m])
        c.hear(0.002)
    a = c.heard(lambda: c.verdict(chunks))
    assert a.code == 0, a.reason
    c.job_where("mixed", "done")
    c.hear(0.2)
    assert all(c.acks_to(m.seq) for m in chunks)


def test_a_lost_chunk_is_repaired_by_its_repeat(machine):
    c = machine.client
    chunks = c.chunks(LONG_JOB, "lossy", size=1000)
    lost = chunks[3]
    c.send([m for m in chunks if m is not lost])
    c.hear(0.5)
    assert not c.acks_to(lost.seq)
    assert c.verdict(chunks) is None
    assert c.job("lossy") is None
    c.send([lost])
    assert c.heard(lambda: c.verdict(chunks)).code == 0
    c.job_where("lossy", "done")


def test_a_text_that_does_not_fit_its_hash_is_refused(machine):
    c = machine.client
    chunks = c.chunks(QUICK_JOB, "forged")
    chunks[0].data = QUICK_JOB.replace(b"X0.2", b"X0.9")
    c.send(chunks)
    a = c.heard(lambda: c.verdict(chunks))
    assert a.code == 76
    assert "SHA-256" in a.reason
    assert c.job("forged") is None
    # The id is free for the right one.
    assert c.submit(QUICK_JOB, "forged").code == 0
    c.job_where("forged", "done")


def test_a_truncated_upload_never_becomes_a_job(machine):
    c = machine.client
    chunks = c.chunks(LONG_JOB, "cut", size=1000)
    c.send(chunks[:-1])
    c.hear(1.0)
    assert c.verdict(chunks) is None
    assert c.job("cut") is None
    assert json.loads(c.ask("queue").body) == []
    assert c.submit(QUICK_JOB, "next").code == 0
    c.job_where("next", "done")


def test_the_same_id_twice_is_one_job(machine):
    c = machine.client
    first = c.submit(QUICK_JOB, "twin")
    again = c.submit(QUICK_JOB, "twin")
    assert (first.code, again.code) == (0, 0)
    assert json.loads(first.body)["n"] == json.loads(again.body)["n"]
    c.job_where("twin", "done")
    c.hear(0.5)
    assert len(json.loads(c.ask("history").body)) == 1
    assert [e.kind for e in c.events].count("begun") == 1
    other = c.submit(SLOW_JOB, "twin")
    assert other.code == 65
    assert "id" in other.reason


def test_a_missed_verdict_is_told_again(machine):
    c = machine.client
    chunks = c.chunks(b"G1 X1 F60 Q9\n", "missed")
    for _ in range(2):
        c.acks.clear()
        c.send(chunks)
        a = c.heard(lambda: c.verdict(chunks))
        assert a.code == 65
        assert a.reason.startswith("job.ngc:1:11: error: ")


def test_bad_code_is_refused_with_line_and_column(machine):
    c = machine.client
    a = c.submit(b"G21 G90\nG1 X1 F60\nG1 X5 Q7\n", "bad", name="bad.ngc")
    assert a.code == 65
    assert a.reason.startswith("bad.ngc:3:7: error: ")
    where = json.loads(a.body)
    assert (where["line"], where["column"]) == (3, 7)
    assert where["found"] and where["wanted"]
    assert c.job("bad") is None


def test_the_name_of_a_job_picks_its_dialect(machine):
    c = machine.client
    a = c.submit(b"B100 B0 B100 GX L1\nB100 0 B100 GX L3\n", "bad3b",
                 name="part.3b")
    assert a.code == 65
    assert a.reason.startswith("part.3b:2:6: error: 0 where a B should be")
    a = c.submit(b"B100 B0 B100 GX L1\nDD\n", "good3b", name="part.3B",
                 hold=True)
    assert a.code == 0, a.reason
    assert c.submit(b"B100 B0 B100 GX L1\nDD\n", "no3b").code == 65


def test_chunks_out_of_bounds_are_refused(machine):
    c = machine.client
    for change, code in (
        ({"chunk": 5}, 76), ({"chunks": 0}, 76), ({"offset": 10**9}, 76),
        ({"offset": -1}, 76), ({"bytes": -1}, 65), ({"bytes": 2**40}, 65),
        ({"job": "../x"}, 65), ({"job": ""}, 65), ({"name": ""}, 65),
        ({"client": ""}, 76), ({"chunk": -1}, 76), ({"chunks": 2**30}, 76),
        ({"name": "a\nb"}, 65), ({"job": "x" * 64}, 65),
    ):
        m = c.chunks(QUICK_JOB, "bounds")[0]
        for key, value in change.items():
            setattr(m, key, value)
        n = len(c.acks)
        c.send([m])
        c.heard(lambda: len(c.acks) > n)
        assert c.acks[n].code == code, change
    big = c.chunks(b"(" + b"x" * CHUNK + b")\n", "bounds", size=CHUNK + 1)
    c.send(big[:1])
    assert c.heard(lambda: c.acks_to(big[0].seq))[0].code == 76
    assert c.submit(QUICK_JOB, "bounds").code == 0
    c.job_where("bounds", "done")


def test_packets_of_no_shape_harm_nothing(machine):
    c = machine.client
    whole = c.chunks(QUICK_JOB, "shape")[0].encode()
    draw = random.Random(2)
    for i in range(400):
        bad = bytearray(whole)
        for _ in range(draw.randrange(1, 6)):
            bad[draw.randrange(8, len(bad))] = draw.randrange(256)
        bad = bad[:draw.randrange(len(bad))] if i % 2 else bad
        channel = ("JOB", "COMMAND")[i % 3 == 0]
        c.publish(channel, bytes(bad))
        c.hear(0.001)
    assert machine.jobs.poll() is None
    # Some were fit to be answered, to a seq that nobody used.  A job that came
    # through may be held, or begin inside: it is not in the way.
    c = Client(machine.name)
    while c.status().job:
        c.ask("stop")
        c.hear(0.2)
    for job in json.loads(c.ask("queue").body):
        c.ask("remove", job["job"])
    assert c.submit(QUICK_JOB, "good").code == 0
    c.job_where("good", "done")


def test_a_third_upload_of_a_client_is_asked_to_try_again(machine):
    c = machine.client
    for i in range(2):
        c.send(c.chunks(LONG_JOB, f"half{i}", size=1000)[:1])
    c.heard(lambda: len(c.acks) == 2)
    assert all(a.code == 0 for a in c.acks)
    third = c.chunks(LONG_JOB, "third", size=1000)
    c.send(third[:1])
    assert c.heard(lambda: c.acks_to(third[0].seq))[0].code == 75


def test_eight_uploads_that_stand_still_lock_nobody_out(machine):
    c = machine.client
    for i in range(8):
        c.name = f"slow-{i}"
        c.send(c.chunks(LONG_JOB, f"half{i}", size=1000)[:1])
    c.hear(2.5)
    c.name = "other"
    assert c.submit(QUICK_JOB, "mine").code == 0
    c.job_where("mine", "done")


def test_jobs_wait_their_turn(machine):
    c = machine.client
    for i in range(3):
        assert c.submit(QUICK_JOB, f"q{i}").code == 0
    for i in range(3):
        c.job_where(f"q{i}", "done")
    begun = [e.job for e in c.events if e.kind == "begun"]
    assert begun == ["q0", "q1", "q2"]


def test_a_job_with_hold_waits_for_start(machine):
    c = machine.client
    assert c.submit(QUICK_JOB, "patient", hold=True).code == 0
    c.job_where("patient", "ready")
    c.hear(0.5)
    assert c.job("patient")["state"] == "ready"
    assert c.ask("start").code == 0
    c.job_where("patient", "done")


def test_a_text_that_is_compiled_for_long_holds_no_end_up(machine):
    """The same text, to its end and not: the processor's time tells."""
    text = (b"G21 G90\nG1 X1 F60\nM98 P1000 L9999\nM30\n"
            b"O1000\nM98 P2000 L9999\nM99\nO2000\nG90\nM99\n")
    c, used = machine.client, []
    for is_whole in (True, False):
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        if used:
            machine.start_jobs()
            c.status_where(lambda s: s.daemon == "ok")
        chunks = c.chunks(text, "long")
        c.send(chunks)
        if is_whole:
            a = c.heard(lambda chunks=chunks: c.verdict(chunks), 60)
            assert a.code == 65 and "32000000 lines" in a.reason
        else:
            c.heard(lambda chunks=chunks: [
                a for a in c.acks_to(chunks[0].seq)
                if a.reason == "whole; compiling"])
        assert machine.end("jobs") == 0
        used.append(resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
                    - before)
    assert used[1] < used[0] / 2, used
    machine.start_jobs()
