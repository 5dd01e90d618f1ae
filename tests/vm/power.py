# SPDX-License-Identifier: Apache-2.0
"""A host whose power fails: a guest that is killed, and its disk.

A boot of the virtual machine costs more than what is to be tested.  So the
guest boots once, up to the place where it would load the driver of its disk
(torture-init), and its memory is saved.  Each boot after that goes on from this
memory, loads the driver and mounts the disk; nothing of the boots before is in
it.  One emulated CPU counts instructions, so a busy host makes it slower and
not later.
"""

import json
import pathlib
import random
import re
import shutil
import socket
import subprocess
import tempfile
import time

from boot import BUILD, BUILD_VM, HERE, ROOT

RUNS = BUILD_VM / "runs"
WATCH_S = 0.02
MEMORY_MB = 320
HANGS_S = 7200          # of the host: far above what a busy one needs for a boot
APPLETS = "grep sed tail date umount"
FIELDS = ("cycle", "state", "fault", "loaded", "place", "far", "length", "feed",
          "x", "y", "z")


def libraries(programs):
    said = subprocess.run(["ldd", *programs], check=True, text=True,
                          stdout=subprocess.PIPE).stdout
    return sorted(set(re.findall(r"(/\S+) \(0x", said)))


def initramfs(to):
    """That of the other tests, and behind it what this guest runs."""
    root = pathlib.Path(tempfile.mkdtemp())
    (root / "bin").mkdir()
    programs = [BUILD / p for p in ("edmd", "edmd-jobs", "edmctl")]
    helper = root / "bin/torture-help"
    subprocess.run(["cc", "-D_GNU_SOURCE", "-O1", "-o", helper,
                    HERE / "torture-help.c",
                    *(f"-I{ROOT / d}" for d in (
                        "daemon/shm", "common", "daemon/words")),
                    *sorted((ROOT / "daemon/shm").glob("*.c")),
                    BUILD / "common.a"], check=True)
    for program in programs:
        subprocess.run(["strip", "-o", root / "bin" / program.name, program],
                       check=True)
    for library in libraries([*programs, helper]):
        at = root / library[1:]
        at.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(library, at)
    for applet in APPLETS.split():
        (root / "bin" / applet).symlink_to("busybox")
    shutil.copy(HERE / "torture-init", root)
    more = subprocess.run("find . | cpio -o -H newc --quiet -R 0:0", cwd=root,
                          shell=True, check=True, stdout=subprocess.PIPE)
    to.write_bytes((BUILD_VM / "initramfs.cpio").read_bytes() + more.stdout)
    shutil.rmtree(root)


def drive(disk, log=None):
    """Options: a disk with a cache, and a log of what is written and flushed,
    in the format of the kernel's dm-log-writes."""
    if log is None:
        return ["-blockdev", f"raw,node-name=disk,file.driver=file,"
                             f"file.filename={disk},cache.no-flush=on"]
    return ["-blockdev", f"file,node-name=data,filename={disk}",
            "-blockdev", f"file,node-name=log,filename={log}",
            "-blockdev", "blklogwrites,node-name=disk,file=data,log=log,"
                         "log-sector-size=512"]


def connect(path):
    """To a socket of QEMU, which may not listen yet."""
    end = time.monotonic() + HANGS_S
    while True:
        s = socket.socket(socket.AF_UNIX)
        try:
            s.connect(str(path))
            return s
        except OSError:
            s.close()
            assert time.monotonic() < end, f"nobody listens on {path}"
            time.sleep(0.02)


class Monitor:
    """QEMU's own commands."""

    def __init__(self, folder):
        self.socket = connect(folder / "monitor")
        self.file = self.socket.makefile("rw")
        self.file.readline()
        self.ask("qmp_capabilities")
        # The memory is in a file already.
        self.ask("migrate-set-capabilities", capabilities=[
            {"capability": "x-ignore-shared", "state": True}])

    def __enter__(self):
        return self

    def __exit__(self, *why):
        self.file.close()
        self.socket.close()

    def ask(self, what, **arguments):
        json.dump({"execute": what, "arguments": arguments}, self.file)
        self.file.write("\n")
        self.file.flush()
        while "return" not in (got := json.loads(self.file.readline())):
            assert "error" not in got, got
        return got["return"]

    def until_migrated(self):
        while (now := self.ask("query-migrate").get("status")) != "completed":
            assert now != "failed"
            time.sleep(0.02)


class Guest:
    """What every boot goes on from, in a folder of its own."""

    def __init__(self):
        self.folder = RUNS / "torture"
        shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir(parents=True)
        self.state = self.folder / "state"
        initramfs(self.folder / "initramfs.cpio")
        with open(self.folder / "disk", "wb") as f:
            f.truncate(1 << 20)
        (self.folder / "job").mkdir()
        self.boot()

    def qemu(self, folder, disk, share, shared):
        """A guest in @folder.  Where its memory is @shared it stays in the file;
        else it is read from there, and what is written is its own."""
        khz = 1000000
        append = ("console=ttyS0 quiet panic=-1 reboot=t nokaslr "
                  "mitigations=off audit=0 lsm=capability tsc=reliable "
                  f"tsc_early_khz={khz} lpj={khz * 4} cryptomgr.notests "
                  "initcall_blacklist=init_kprobe_trace rdinit=/torture-init")
        for name in ("tty", "monitor"):
            (folder / name).unlink(missing_ok=True)
        return subprocess.Popen([
            "qemu-system-x86_64", "-accel", "tcg,thread=single,tb-size=256",
            "-icount", "shift=2,sleep=on", "-smp", "1", "-m", f"{MEMORY_MB}",
            "-M", "q35,usb=off,smbus=off,sata=off,vmport=off,i8042=off,"
                  "memory-backend=ram",
            "-object", f"memory-backend-file,id=ram,size={MEMORY_MB}M,"
                       f"mem-path={self.folder}/ram,"
                       f"share={'on' if shared else 'off'}",
            "-cpu", "max", "-nodefaults", "-no-user-config",
            "-display", "none", "-no-reboot",
            "-kernel", BUILD_VM / "vmlinux", "-append", append,
            *(["-initrd", self.folder / "initramfs.cpio"] if shared else
              ["-incoming", "defer"]),
            "-chardev", f"socket,id=tty,path={folder}/tty,server=on,wait=off,"
                        f"logfile={folder}/console",
            "-serial", "chardev:tty",
            "-chardev", f"socket,id=monitor,path={folder}/monitor,"
                        "server=on,wait=off", "-mon", "monitor,mode=control",
            "-fsdev", f"local,id=job,path={share},security_model=none,"
                      "multidevs=remap",
            "-device", "virtio-9p-pci,fsdev=job,mount_tag=job",
            *disk, "-device", "virtio-blk-pci,drive=disk"],
            stdin=subprocess.DEVNULL, stdout=open(folder / "qemu.log", "w"),
            stderr=subprocess.STDOUT)

    def boot(self):
        vm = self.qemu(self.folder, drive(self.folder / "disk"),
                       self.folder / "job", True)
        said = self.folder / "console"
        while not (said.exists() and b"ready" in said.read_bytes()):
            assert vm.poll() is None, (self.folder / "qemu.log").read_text()
            time.sleep(0.05)
        with Monitor(self.folder) as m:
            m.ask("migrate", uri=f"exec:cat > {self.state}")
            m.until_migrated()
            m.ask("quit")
        vm.wait()

    def go_on(self, folder, disk, share):
        """Boot with this disk and folder.  Return: the process."""
        (share / "here").unlink(missing_ok=True)
        vm = self.qemu(folder, disk, share, False)
        with Monitor(folder) as m:
            m.ask("migrate-incoming", uri=f"exec:cat {self.state}")
            m.until_migrated()
        with connect(folder / "tty") as s:
            while not (share / "here").exists():
                assert vm.poll() is None, (folder / "qemu.log").read_text()
                s.sendall(b"\ngo %d\n" % time.time())
                time.sleep(0.1)
        return vm


class Power:
    """A machine with a disk that no other one has used."""

    def __init__(self, guest, name, files):
        self.guest, self.turn = guest, 0
        self.folder = RUNS / f"torture-{name}"
        shutil.rmtree(self.folder, ignore_errors=True)
        self.share = self.folder / "share"
        self.share.mkdir(parents=True)
        self.disk = self.folder / "disk"
        for file, text in files.items():
            (self.share / file).write_text(text)
        shutil.copy(HERE / "guest/torture.sh", self.share)
        with open(self.disk, "wb") as f:
            f.truncate(64 << 20)
        subprocess.run(["/sbin/mkfs.ext4", "-q", self.disk], check=True)

    def has(self, file):
        path = self.share / f"{file}.{self.turn}"
        return path.exists() and path.stat().st_size > 0

    def json(self, file):
        return json.loads((self.share / f"{file}.{self.turn}").read_text())

    def text(self, file):
        path = self.share / f"{file}.{self.turn}"
        return path.read_text() if path.exists() else ""

    def seen(self):
        """What was seen of edmd in this turn, whole lines only."""
        number = int, str, int, int, *(float,) * 4, *(int,) * 3
        return [dict(zip(FIELDS, (n(word) for n, word in zip(
            number, line.split())))) for line in
            self.text("seen").rpartition("\n")[0].splitlines()]

    def boot(self, kill_after_s, log=None):
        """Run it, and kill it when edmd is so old, in s of the guest's time;
        None: let it end.  @log: file for what is written to the disk.
        Return: was it killed?"""
        self.turn += 1
        for file in ("rc", "history"):
            (self.share / file).unlink(missing_ok=True)
        (self.share / "turn").write_text(f"{self.turn}\n")
        vm = self.guest.go_on(self.folder, drive(self.disk, log), self.share)
        end = time.monotonic() + HANGS_S
        while vm.poll() is None and time.monotonic() < end:
            if kill_after_s is not None and \
                    self.text("seen").count("\n") >= kill_after_s / WATCH_S:
                # Anywhere between two looks.
                time.sleep(random.uniform(0, 2 * WATCH_S))
                break
            time.sleep(0.02)
        killed = vm.poll() is None
        vm.kill()
        vm.wait()
        rc = self.share / "rc"
        if killed and not rc.exists():
            assert kill_after_s is not None, "it did not end"
            return True
        output = self.share / "output"
        assert rc.read_text() == "0\n", output.read_text() + self.text("told")
        return False
