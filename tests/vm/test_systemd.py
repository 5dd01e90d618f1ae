# SPDX-License-Identifier: Apache-2.0
"""systemd as PID 1, and the unit as `make install` puts it."""


def test_the_service_says_itself_when_it_is_ready(systemd):
    said = systemd.words("start")
    assert said["pid1"] == "systemd"
    assert said["type"] == "notify"
    assert said["start"] == "0", systemd.text("journal")
    assert said["active"] == "active/running"


def test_it_runs_as_a_user_with_one_thread_in_real_time(systemd):
    said = systemd.words("start")
    assert said["user"] == "edmd"
    assert said["fifo"] == "1"


def test_what_is_shared_is_made_for_the_group_and_nobody_else(systemd):
    """By edmd.tmpfiles; the socket of commands is in it.  Each of the two makes
    its files in its own folder, and nobody else can take a name there."""
    rows = dict(r.split(" ", 1) for r in
                systemd.text("shared").splitlines())
    jobs = dict(r.split(" ", 1) for r in
                systemd.text("shared-jobs").splitlines())
    print(rows, jobs)
    assert rows["."] == "drwxr-x--- edmd edm"
    assert jobs["."] == "drwxr-x--- edm-jobs edm"
    assert jobs["edmd.vm.writer"] == "-rw------- edm-jobs edm"
    assert rows["edmd.vm.command"] == "srw-rw---- edmd edm"
    assert rows["edmd.vm.status"] == "-rw-r----- edmd edm"
    assert all(r.split()[0].endswith("---") for n, r in rows.items()
               if n != "."), rows
    assert "Permission denied" in systemd.text("shared-nobody")


def test_a_program_on_the_network_sees_no_key(systemd):
    """It is in group edm, for the status."""
    said = systemd.text("dds-sees")
    print(said)
    assert "(edm)" in said and "\n4\n" in said
    assert "secret" not in said
    assert said.count("Permission denied") == 3


def test_the_unit_lets_it_have_its_chips(systemd):
    assert "backend gpio" in systemd.text("journal")
    assert systemd.words("watchdog")["spark"] == "1", \
        systemd.text("watchdog") + systemd.text("journal")


SPARK, WATCHDOG = "0", "1"      # lines of chip sim1


def levels(text, wanted):
    """Time and level of each write to a line."""
    return [(float(t), level) for t, line, level in
            map(str.split, text.splitlines()) if line == wanted]


def watchdog_edges(systemd):
    """Times of the edges of the watchdog's wave."""
    writes = levels(systemd.text("watchdog.trace"), WATCHDOG)
    return [t for (_, was), (t, now) in zip(writes, writes[1:]) if now != was]


def test_the_watchdogs_wave_ends_with_the_cycle(systemd):
    """What stops the generator while nobody can switch it off."""
    said = systemd.words("watchdog")
    stopped = float(said["stopped-at"])
    edges = watchdog_edges(systemd)
    gap, begun = max((b - a, a) for a, b in zip(edges, edges[1:]))
    print(f"no edge for {gap:.2f} s, from {begun - stopped:.2f} s after the "
          "stop was asked for")
    assert gap > 1.5
    assert -0.5 < begun - stopped < 5


def test_systemd_restarts_a_cycle_that_stands(systemd):
    said = systemd.words("watchdog")
    took = float(said["restart-seen-at"]) - float(said["stopped-at"])
    print(f"restart seen {took:.1f} s after the stop was asked for")
    assert said["restarts"] == "1", systemd.text("journal")
    assert said["active-again"] == "active/running"
    assert "Watchdog timeout" in systemd.text("journal")


def test_one_that_is_stopped_is_replaced_within_its_watchdogs_time(systemd):
    """It heeds no signal but SIGKILL; its lines stay as they are till then.
    The generator's own watchdog is what ends the sparks meanwhile."""
    writes = levels(systemd.text("frozen.trace"), SPARK)
    gap, at = max((b[0] - a[0], i) for i, (a, b) in
                  enumerate(zip(writes, writes[1:])))
    before, after = writes[:at + 1], writes[at + 1:]
    assert writes[0][1] == "1", "the trace begins while sparks are on"
    print(f"no write for {gap:.1f} s; sparks on for so long after the stop")
    assert gap > 1.5
    assert {level for _, level in before} == {"1"}
    assert {level for _, level in after} == {"0"}, "sparks came back"
    journal = systemd.text("journal")
    assert journal.count("Watchdog timeout (limit 2s)") == 2
    assert "Main process exited, code=killed, status=9/KILL" in journal
    # What heeds SIGKILL alone is not waited for, 10 s, after another signal.
    assert "timed out. Killing" not in journal


def test_no_spark_comes_back_before_a_start(systemd):
    said = systemd.words("watchdog")
    assert said["spark-after-kill"] == "0"
    assert said["spark-held"] == "0"
    assert said["spark-again"] == "1"
    assert said["spark-idle"] == "0"
    assert said["stop"] == "0 success"
