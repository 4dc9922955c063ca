#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The OCI image of the packages in build/deb: of the same bytes each time, read by the tools of others,
small, and run as a container is: as its user, in namespaces of its own, with a read-only root.

Each architecture that build/deb has packages of is looked at; those of another machine run in qemu-user.
"""

import contextlib
import json
import os
import pathlib
import re
import shlex
import shutil
import signal
import subprocess
import sys
import urllib.request

import owsdtest
from owsdtest import SOURCE, until

DEBS = pathlib.Path(os.environ.get("OWSD_DEBS", SOURCE / "build/deb"))
EMULATOR = {"arm64": "qemu-aarch64-static", "armhf": "qemu-arm-static"}
SIZE = 40e6  # unpacked; a tenth of it are owsd and its faces
HERE = subprocess.run(["dpkg", "--print-architecture"], capture_output=True, text=True, check=False).stdout.strip()
SUITE = next((line.split("=")[1] for line in pathlib.Path("/etc/os-release").read_text().splitlines()
              if line.startswith("VERSION_CODENAME=")), "")
VERSION = next(line.split()[-1] for line in (SOURCE / "Makefile").read_text().splitlines() if line.startswith("VERSION "))
LAYOUT = []


def run(*command, limit=900, **options):
    done = subprocess.run([str(c) for c in command], text=True, timeout=limit, check=False, stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, **options)
    assert done.returncode == 0, f"{command}: {done.returncode}: {done.stdout[-2000:]}"
    return done.stdout


def architectures():
    found = sorted({file.stem.rpartition("_")[2] for file in DEBS.glob(f"owsd-mqtt_{VERSION}+*.deb")})
    if HERE not in found:
        owsdtest.skip(f"{DEBS} has no packages of {VERSION} for {HERE}: make deb")
    return found


def layout():
    """The image, made once for all cases."""
    if not shutil.which("mmdebstrap"):
        owsdtest.skip("mmdebstrap is not installed (sh board/install-deps oci)")
    found = architectures()
    if not LAYOUT:
        LAYOUT.append(owsdtest.folder() / "oci")
        run(sys.executable, SOURCE / "board/make-oci", "--debs", DEBS, "--out", LAYOUT[0], *found)
    return LAYOUT[0]


def blob(folder, descriptor):
    return folder / "blobs/sha256" / descriptor["digest"].split(":")[1]


def root_of(scene, arch):
    """The root of that image, as a runtime unpacks it."""
    if os.geteuid() or not shutil.which("umoci"):
        owsdtest.skip("needs root and umoci (sh board/install-deps oci)")
    bundle = scene.path / arch
    run("umoci", "unpack", "--image", f"{layout()}:{VERSION}-{arch}", bundle)
    return bundle / "rootfs"


# A bind mount of the root, which is read-only but for what a container is given
INSIDE = """
mount --bind $0 $0 && mount -t proc proc $0/proc && mount -t tmpfs tmpfs $0/dev
touch $0/dev/null && mount --bind /dev/null $0/dev/null
for place in run/owsd var/lib; do mount -t tmpfs -o uid=4304,gid=4304,mode=755 tmpfs $0/$place; done
mount -o remount,ro,bind $0 && exec chroot --userspec=4304:4304 $0 "$@"
"""


def contained(root, *command):
    """A command as the first process of a container with that root, without a right. It has a session of
    its own and another user, who is asked for no end with its parent: so it lives in the processes of
    another, which end with that one."""
    ends = ["unshare", "-p", "-f", "--kill-child"]
    return [*ends, *ends, "-m", "setsid", "sh", "-ec", INSIDE, root, *command]


def test_the_same_packages_give_the_same_bytes(scene):
    again = scene.path / "again"
    first = layout()
    run(sys.executable, SOURCE / "board/make-oci", "--debs", DEBS, "--out", again, *architectures())
    assert (first / "index.json").read_bytes() == (again / "index.json").read_bytes()


def test_the_index_has_each_architecture_and_each_image_is_small(_scene):
    folder = layout()
    top = json.loads((folder / "index.json").read_text())["manifests"]
    names = [entry["annotations"]["org.opencontainers.image.ref.name"] for entry in top]
    assert names == [VERSION, *(f"{VERSION}-{arch}" for arch in architectures())], names
    for descriptor in json.loads(blob(folder, top[0]).read_text())["manifests"]:
        manifest = json.loads(blob(folder, descriptor).read_text())
        packed, = manifest["layers"]
        assert packed["size"] < SIZE / 2, packed
        config = json.loads(blob(folder, manifest["config"]).read_text())
        assert config["architecture"] == descriptor["platform"]["architecture"] and config["config"]["User"] == "4304"


def test_skopeo_reads_each_image(_scene):
    if not shutil.which("skopeo"):
        owsdtest.skip("skopeo is not installed (sh board/install-deps oci)")
    folder = layout()
    for arch in architectures():
        said = json.loads(run("skopeo", "inspect", f"oci:{folder}:{VERSION}-{arch}"))
        assert said["Architecture"] == {"armhf": "arm"}.get(arch, arch) and len(said["Layers"]) == 1, said
        assert said["Labels"]["org.opencontainers.image.version"] == VERSION


def test_each_program_of_each_architecture_starts(scene):
    for arch in architectures():
        root = root_of(scene, arch)
        emulator = [] if arch == HERE else [shutil.which(EMULATOR[arch]), "-L", root]
        if emulator and not emulator[0]:
            owsdtest.skip(f"{EMULATOR[arch]} is not installed")
        programs = sorted((root / "usr/sbin").glob("owsd*"))
        faces = [row.split("|")[0].strip() for row in (SOURCE / "board/faces").read_text().splitlines() if row[0] != "#"]
        assert [p.name for p in programs] == sorted(["owsd", *faces]), programs
        for program in [*programs, root / "usr/bin/owsctl"]:
            inside = f"/{program.relative_to(root)}"
            command = [*emulator, program] if emulator else contained(root, inside)
            assert VERSION in run(*command, "-V" if program.name != "owsctl" else "--version"), (arch, program)
        size = sum(f.lstat().st_size for f in root.rglob("*") if f.is_file() and not f.is_symlink())
        assert size < SIZE, f"{arch}: {size / 1e6:.1f} MB"
        assert "BEGIN CERTIFICATE" in (root / "etc/ssl/certs/ca-certificates.crt").read_text()
        assert (root / "usr/share/doc/libc6/copyright").exists() and (root / "usr/share/doc/owsd/sbom.cdx.json").exists()


class Container:
    """The image of this machine, run."""

    def __init__(self, scene, faces, rio):
        self.root = root_of(scene, HERE)
        (self.root / "etc/owsd/OWS.rio").write_text(rio)
        self.program = scene.start(contained(self.root, "/usr/bin/owsd-entry"), env={"OWS_DIR": "/run/owsd", "OWSD_FACES": faces, "PATH": "/usr/sbin:/usr/bin:/sbin:/bin"})

    def processes(self):
        """Their numbers and names: the first is the container's first."""
        of = {}
        for entry in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                name, rest = (entry / "stat").read_text().split("(", 1)[1].rsplit(")", 1)
                of.setdefault(int(rest.split()[1]), []).append((int(entry.name), name))
            except OSError:
                continue
        found, left = [], [child for pid, _ in of.get(self.program.pid, []) for child in of.get(pid, [])]
        while left:
            found += left
            left = [child for pid, _ in left for child in of.get(pid, [])]
        return found

    def names(self):
        return [name for _, name in self.processes()]

    def shell(self, text):
        pid = self.processes()[0][0]
        return subprocess.run(["nsenter", "-t", str(pid), "-m", "-p", "chroot", "--userspec=4304:4304", self.root,
                               "/usr/bin/sh", "-c", text], capture_output=True, text=True, timeout=60, check=False,
                              env={"OWS_DIR": "/run/owsd", "PATH": "/usr/sbin:/usr/bin"})

    def owsctl(self, *words):
        return self.shell(shlex.join(["owsctl", *words]))


def house(port, more=""):
    return (f'OwsDrv {{\n  TargetName "127.0.0.1:{port}"\n{more}  ItemCount 1\n  Item {{\n    Name "room"\n'
            '    Path "/10.67C6697351FF/temperature"\n    Type "double"\n  }\n}\n')


def server(scene):
    return scene.owserver(fake=["10.67C6697351FF"])


def test_without_faces_the_container_is_owsd_alone_with_good_values(scene):
    container = Container(scene, "", house(server(scene).port))
    until(lambda: container.processes() and container.owsctl("get", "room").returncode == 0, 60, container.program.log)
    assert set(container.names()) <= {"owsd", "owsd-porter"}, container.names()
    assert container.owsctl("stats").returncode == 0
    os.kill(container.processes()[0][0], 15)
    assert container.program.process.wait(30) == 0, container.program.log()


def test_what_the_compose_file_and_its_page_run_in_the_container_does_its_work(scene):
    healthy = re.search(r'^ +test: \[CMD-SHELL, "(.*)"\]$', (SOURCE / "board/oci/compose.yaml").read_text(), re.M)[1]
    scan = re.search(r"^docker compose exec owsd (.*)$", (SOURCE / "docs/distributions.md").read_text(), re.M)[1]
    assert scan in (SOURCE / "board/oci/owsd/OWS.rio").read_text()
    container = Container(scene, "", house(server(scene).port))
    until(lambda: container.processes() and container.owsctl("get", "room").returncode == 0, 60, container.program.log)
    done = container.shell(scan)
    assert done.returncode == 0 and "Item {" in done.stdout and "10.67C6697351FF" in done.stdout, done
    assert container.shell(healthy).returncode == 0
    owsd, = [pid for pid, name in container.processes() if name == "owsd"]
    for number, wanted in ((signal.SIGSTOP, False), (signal.SIGCONT, True)):
        os.kill(owsd, number)
        until(lambda: (container.shell(healthy).returncode == 0) == wanted, 60, container.program.log)


def test_the_faces_that_are_asked_for_run_beside_owsd_and_one_that_dies_comes_back(scene):
    port = owsdtest.free_port()
    rio = house(server(scene).port, f'  Web {{\n    Listen "127.0.0.1:{port}"\n  }}\n')
    container = Container(scene, "web recorder modbus", rio)

    def page():
        try:
            with urllib.request.urlopen(f"http://127.0.0.1:{port}/api/summary", timeout=5) as answer:
                return answer.status == 200
        except OSError:
            return False
    until(page, 60, container.program.log)
    assert {"owsd", "owsd-web", "owsd-recorder", "owsd-modbus"} <= set(container.names()), container.names()
    before = dict(container.processes())
    for pid, name in before.items():
        if name == "owsd-web":
            os.kill(pid, 9)
    until(lambda: not page(), 20, container.program.log)
    until(page, 60, container.program.log)
    after = dict(container.processes())
    assert {pid for pid, name in before.items() if name == "owsd"} == {pid for pid, name in after.items() if name == "owsd"}
    assert "owsd-web has ended" in container.program.log()
    until(lambda: container.owsctl("trend", "room").returncode == 0, 60, container.program.log)
    os.kill(container.processes()[0][0], 15)
    assert container.program.process.wait(60) == 0, container.program.log()
    assert not container.processes()


def test_a_test_that_is_cut_off_leaves_no_process(scene):
    container = Container(scene, "recorder", house(server(scene).port))
    until(lambda: "owsd-recorder" in container.names(), 60, container.program.log)
    living = [pid for pid, _ in container.processes()]
    container.program.kill()

    def left():
        found = []
        for pid in living:
            with contextlib.suppress(OSError):
                found.append(pathlib.Path(f"/proc/{pid}/cmdline").read_text())
        return [words for words in found if words]
    until(lambda: not left(), 20, lambda: str(left()))


def test_a_face_that_is_none_is_refused_with_those_that_there_are(scene):
    container = Container(scene, "web mqqt", house(1))
    assert container.program.process.wait(60) == 2
    said = container.program.log()
    assert "OWSD_FACES names mqqt" in said and " mqtt" in said and " recorder" in said, said


if __name__ == "__main__":
    owsdtest.main()
