# SPDX-License-Identifier: Apache-2.0
"""The Debian packages in a guest with systemd: dpkg installs, upgrades, removes
and purges them.  That their dependencies can be had on a fresh Debian 12 is
shown by tests/fresh-root; here the host's libraries are used."""

UNITS = ("edmd.service", "edmd-jobs.service", "edm-dds.service",
         "edm-panel.service")


def test_installing_starts_nothing(packages):
    said = packages.words("installed")
    assert said["install"] == "0", packages.text("install.log")
    assert {said[u] for u in UNITS} == {"inactive"}
    assert said["template"] == "null"
    assert said["users"].split() == ["edmd", "edm-jobs", "edm-panel"]


def test_an_upgrade_leaves_a_held_job_and_who_holds_it_alone(packages):
    said = packages.words("upgraded")
    print(packages.text("upgraded"), packages.text("upgrade.log"))
    assert said["start"] == "0", packages.text("journal")
    assert said["upgrade"] == "0"
    assert said["version"] == "0.1.1-0edmd1"
    assert said["edmd"] == said["edmd-jobs"] == "same"
    assert said["before"] == "held"
    assert packages.text("show-after") == packages.text("show-before")
    assert "held" in packages.text("show-after")


def test_the_job_goes_on_after_an_upgrade(packages):
    assert "after goes-on\n" in packages.text("upgraded")


def test_the_new_programs_take_the_held_job_over(packages):
    said = packages.words("upgraded")
    assert said["restart"] == "0" and said["edmd-later"] == "new"
    assert said["restarted"] == "held"
    assert "held" in packages.text("show-restarted")
    assert said["job"] == "done", packages.text("journal")


def test_what_holds_no_job_is_started_anew(packages):
    said = packages.words("upgraded")
    assert said["edm-panel"] == "new" and said["panel"] == "active"


def test_the_users_machine_file_is_kept(packages):
    assert packages.words("upgraded")["config"] == "mine"
    assert packages.words("removed")["config"] == "kept"


def test_what_is_removed_ends_and_leaves_its_files_alone(packages):
    said = packages.words("removed")
    assert said["remove"] == "0", packages.text("remove.log")
    assert {said[u] for u in UNITS} == {"inactive"}
    assert said["store"] == "kept"
    left = packages.text("after-remove").split()
    assert [p for p in left if p.startswith("/usr")] == \
        [p for p in packages.text("before").split() if p.startswith("/usr")]


def test_nothing_is_left_when_it_is_purged(packages):
    said = packages.words("removed")
    assert said["purge"] == "0", packages.text("purge.log")
    assert packages.text("after-purge") == packages.text("before")
