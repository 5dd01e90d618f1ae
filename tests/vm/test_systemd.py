# SPDX-License-Identifier: Apache-2.0
"""systemd as PID 1, and the unit as `make install` puts it."""


def test_the_service_says_itself_when_it_is_ready(systemd):
    said = systemd.words("start")
    assert said["pid1"] == "systemd"
    assert said["type"] == "notify"
    assert said["start"] == "0", systemd.text("journal")
    assert said["active"] == "active/running"


def test_it_runs_as_a_user_with_stops_and_the_cycle_in_real_time(systemd):
    said = systemd.words("start")
    assert said["user"] == "edmd"
    stops, cycle = said["fifo"].split()
    assert stops == "edmd-stops=1" and int(cycle.split("=")[1]) > 1, said


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
    sockets = dict(r.split(" ", 1) for r in
                   systemd.text("sockets-jobs").splitlines())
    assert sockets["."] == "drwxr-x--- edm-jobs edm"
    assert sockets["edmd.vm.jobs"] == "srw-rw---- edm-jobs edm"
    sockets = dict(r.split(" ", 1) for r in
                   systemd.text("sockets").splitlines())
    assert sockets["."] == "drwxr-x--- edmd edm"
    assert sockets["edmd.vm.stop"] == "srw-rw---- edmd edm"


def test_a_program_on_the_network_sees_no_key(systemd):
    """It is in group edm, for the status and the socket of edmd-jobs."""
    said = systemd.text("dds-sees")
    print(said)
    assert "(edm)" in said and "\n4\n" in said
    assert "secret" not in said
    assert said.count("Permission denied") == 4


def test_somebody_is_called_by_a_unit_that_is_off_at_first(systemd):
    said = systemd.words("notify")
    print(systemd.text("notify"), systemd.text("journal"))
    assert said["enabled"] == "disabled"
    assert said["without-file"] == "no inactive"
    assert said["active"] == "active/running"
    assert said["user"] not in ("root", "edmd", "edm-jobs")
    assert (said["called"], said["called-again"]) == ("0", "0")
    assert '"machine": "vm"' in systemd.text("notify-called")


def test_the_unit_lets_it_have_its_chips(systemd):
    assert "backend gpio" in systemd.text("journal")
    assert systemd.words("watchdog")["spark"] == "1", \
        systemd.text("watchdog") + systemd.text("journal")


def test_systemd_waits_for_the_interface_of_the_drives(systemd):
    """edmd is not even tried before it is there."""
    text = systemd.text("late-can")
    assert "udev 0\n" in text, text
    assert "without it: waits, inactive\n" in text, text
    assert "later: waits, inactive\ntold before: 0\n" in text, text
    assert "it came: active\n" in text, text + systemd.text("journal")


def test_edmd_is_not_given_up_while_the_interface_is_away_or_down(systemd):
    """8 tries are more than systemd's usual limit of 5 in 10 s."""
    text = systemd.text("late-can")
    for line in "without it: tried", "down: tried again", "up: active":
        assert f"{line}\n" in text, text + systemd.text("journal")
    journal = systemd.text("journal")
    assert "can402.interface can0: No such device" in journal
    assert "can402.interface can0: Network is down" in journal


SPARK, WATCHDOG = "0", "1"      # lines of chip sim1


def levels(systemd, trace, wanted, thread):
    """Time and level of each write to a line, by this thread and by others."""
    writes = [(float(t), level, who) for t, line, level, who in
              map(str.split, systemd.text(trace).splitlines())
              if line == wanted]
    return ([w[:2] for w in writes if w[2] == thread],
            [w[:2] for w in writes if w[2] != thread])


def is_killed(systemd, pid):
    return (f"Killing process {pid} (edmd) with signal SIGKILL" in
            systemd.text("journal"))


def test_the_watchdogs_wave_ends_with_the_cycle(systemd):
    """What stops the generator while nobody can switch it off."""
    said = systemd.words("watchdog")
    stopped = float(systemd.text("stopped-at"))
    before, after = levels(systemd, "watchdog.trace", WATCHDOG,
                           said["stopped-cycle"])
    print(f"{len(before)} writes until {stopped - before[-1][0]:.3f} s before "
          f"the stop; the next {after[0][0] - stopped:.2f} s after it, by the "
          "edmd that systemd has started")
    assert {level for _, level in before} == {"0", "1"}
    assert before[-1][0] <= stopped
    # It had been fed until then, and a new edmd comes 1 s after the old one.
    assert after[0][0] - stopped > 1


def test_systemd_restarts_a_cycle_that_stands(systemd):
    said = systemd.words("watchdog")
    assert is_killed(systemd, said["stopped"]), systemd.text("journal")
    assert said["active-again"] == "active/running"
    assert "Watchdog timeout (limit 2s)" in systemd.text("journal")


def test_one_that_is_stopped_is_replaced_within_its_watchdogs_time(systemd):
    """It heeds no signal but SIGKILL; its lines stay as they are till then.
    The generator's own watchdog is what ends the sparks meanwhile."""
    said = systemd.words("watchdog")
    before, after = levels(systemd, "frozen.trace", SPARK,
                           said["frozen-cycle"])
    assert before[0][1] == "1", "the trace begins while sparks are on"
    print(f"no write for {after[0][0] - before[-1][0]:.1f} s; sparks on for so "
          "long after the stop")
    assert after[0][0] - before[-1][0] > 1
    assert {level for _, level in before} == {"1"}
    assert {level for _, level in after} == {"0"}, "sparks came back"
    journal = systemd.text("journal")
    assert is_killed(systemd, said["frozen"]), journal
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
