# SPDX-License-Identifier: Apache-2.0
"""make install brings programs that find their files, uninstall takes all back;
the Debian packages are made of what it brings"""
import os
import pathlib
import shutil
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = os.environ.get("EDM_BUILD", "build")


def run(*args, **options):
    done = subprocess.run(args, capture_output=True, text=True, timeout=600,
                          **options)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture
def dest(tmp_path):
    return tmp_path / "a place"


@pytest.fixture
def make(dest):
    def make(what):
        run("make", "-C", ROOT, what, f"DESTDIR={dest}", "PREFIX=/usr")
        return {str(f.relative_to(dest)) for f in dest.rglob("*")
                if not f.is_dir()}
    return make


def test_what_is_installed_runs_and_is_taken_back(make, dest, tmp_path):
    there = make("install")
    share = dest / "usr/share/edmd"
    for program in ("edmd", "edmd-jobs", "edmctl", "edmsim"):
        done = subprocess.run([dest / "usr/bin" / program, "--version"],
                              capture_output=True, text=True, timeout=60)
        assert done.returncode == 0, done.stderr
        assert any(f.startswith("usr/share/man/") and
                   pathlib.Path(f).stem == program for f in there), program
    done = subprocess.run(
        [dest / "usr/bin/edmsim", "--machine", share / "examples/wire.ini",
         "--check", share / "examples/taper.ngc"],
        cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr

    mine = dest / "etc/edmd/machine.ini"
    mine.write_text(mine.read_text() + "# mine\n")
    assert make("install") == there
    assert mine.read_text().endswith("# mine\n")
    assert make("uninstall") == {"etc/edmd/machine.ini"}


def test_what_its_user_changed_or_added_is_kept(make, dest):
    make("install")
    share = dest / "usr/share/edmd"
    mine = {share / "dialects/shop.ini", share / "examples/wire.ini"}
    for f in mine:
        f.write_text("; mine\n")
    assert {dest / f for f in make("uninstall")} == \
        mine | {dest / "etc/edmd/machine.ini"}


# -- Packages ------------------------------------------------------------------

PARTS = "packaging", "docs", "libinterp", "clients/python"


def packages(tree, root, out):
    """as packaging/deb makes them in a folder without .git"""
    for part in PARTS:
        shutil.copytree(ROOT / part, tree / part)
    for name in "README.md", "CHANGELOG.md":
        shutil.copy2(ROOT / name, tree / name)
    (tree / "built").mkdir()
    for f in (ROOT / BUILD).glob("*"):
        if f.is_file():
            (tree / "built" / f.name).symlink_to(f)
    run(tree / "packaging/deb", "built", root, out, "0.1", cwd=tree)
    return {f.name: f.read_bytes() for f in (tree / out).iterdir()}


THERE_AND_BACK = r"""
#include <interp/cursor.h>
#include <interp/nc.h>

#include <stdio.h>
#include <stdlib.h>

int main(void)
{
	static const char text[] = "G21 G90\nG1 X2 Y1 F30\nM2\n";
	struct interp_machine m = { .present = 3 };
	struct interp_nc_options o = { .machine = &m };
	struct interp_build *b;
	struct interp_build_about about = { 0 };
	struct interp_nc_result r;
	struct interp_diag d;
	struct interp_program p;
	struct interp_cursor c;
	unsigned n = 0;
	size_t size;
	void *block;

	for (int i = 0; i < INTERP_NAXES; i++)
		m.axis[i] = (struct interp_axis_limits) {
			.pulse_mm = 0.001, .travel_min_mm = -10,
			.travel_max_mm = 10, .v_max_mm_s = 10,
			.a_max_mm_s2 = 100, .j_max_mm_s3 = 1000,
		};
	b = interp_build_create(&(struct interp_build_options) {
		.machine = &m });
	if (interp_nc_compile(&(struct interp_text) { .at = text,
			.bytes = sizeof(text) - 1 }, &o, b, &r, &d)) {
		printf("%s; %s\n", d.found, d.wanted);
		return 1;
	}
	about.lines = r.lines;
	block = interp_build_take(b, &about, &size);
	if (!block || interp_program_map(&p, block, size) ||
	    interp_cursor_init(&c, &p))
		return 1;
	for (int way = 1; way >= -1; way -= 2) {
		interp_cursor_aim(&c, way * 5.0);
		while (interp_cursor_step(&c) == INTERP_MOVED)
			n++;
		printf("%d %d\n", (int)c.pos[0], (int)c.pos[1]);
	}
	return n != 4000;
}
"""


def test_packages_are_made_and_one_builds_programs(make, dest, tmp_path):
    make("install")
    made = [packages(tmp_path / where, dest, "out put")
            for where in ("one", "an other one")]
    assert len(made[0]) == 6 and made[0] == made[1]

    root = tmp_path / "root"
    run("dpkg-deb", "-x", *(tmp_path / "one/out put").glob("libinterp-dev_*"),
        root)
    lib, = root.glob("usr/lib/*/pkgconfig")
    flags = run("pkg-config", "--cflags", "--libs", "libinterp",
                env=os.environ | {"PKG_CONFIG_LIBDIR": lib}).split()
    (tmp_path / "t.c").write_text(THERE_AND_BACK)
    run("cc", "-I", root / "usr/include", tmp_path / "t.c", "-L", lib.parent,
        *flags, "-o", tmp_path / "t")
    assert run(tmp_path / "t").split() == ["2000", "1000", "0", "0"]
